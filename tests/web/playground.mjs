// The playground of the site: somebody who has never seen it writes, fixes and runs a mission; links, nonsense, and figures.
import assert from "node:assert/strict";
import { accessible, fits, visit } from "./browser.mjs";

const [base, pictures] = process.argv.slice(2);
const BUSY = 3; // times as long as it takes on a computer that does nothing else
const COLD = 10_000 * BUSY; // milliseconds until the first run, with nothing in the cache
const KEY = 100 * BUSY; // milliseconds from a key to the tree, of 50 lines
const LINES = ['say "Good morning!" and wave', "go to the kitchen", "look around", 'if nobody is near, say "No coffee today.", otherwise say "Coffee is ready!"', "try up to 2 times: go to the lab", 'otherwise say "I can\'t get there."', "repeat 2 times:", "  wave", "  nod", "go to Alice within 30 s", "# a remark", "wait 2 s", "turn left", "move forward 30 cm", "go back to the lobby"];
const FIFTY = [...LINES, ...LINES, ...LINES, ...LINES].slice(0, 50).join("\n");
const MARKUP = "<img src=x onerror='window.hit = 1'>";

const ready = (page) => page.waitForSelector("body[data-ready]", { timeout: 60_000 });
const says = (page, pattern, seconds = 60) => page.waitForFunction((source) => new RegExp(source).test(document.querySelector("header .state").textContent), pattern.source, { timeout: seconds * 1000 });
const written = (page) => page.$$eval(".try .cm-line", (lines) => lines.map((line) => line.textContent).join("\n"));
const shown = (page) => page.$$eval(".try .node .words", (words) => words.map((each) => each.textContent));
const read = (page) => page.waitForFunction(() => document.querySelector(".try .tree").ariaBusy === "false");
const example = (page, name) => page.selectOption("header select", { label: name });
const button = (page, name) => page.getByRole("button", { name, exact: true });

async function replace(page, text) {
  await page.click(".try .cm-content");
  await page.keyboard.press("Control+A");
  await page.keyboard.insertText(text);
}

const median = (numbers) => [...numbers].sort((one, other) => one - other)[Math.floor(numbers.length / 2)];

await visit(base, async (page, context) => {
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  const picture = (name) => page.screenshot({ path: `${pictures}/${name}.png` });

  // The first run, with nothing in the cache.
  const sizes = new Map();
  page.on("response", (response) => void response.body().then((body) => sizes.set(response.url(), body.length), () => undefined));
  const began = Date.now();
  await page.goto(`${base}/try_it.html`);
  await page.waitForFunction(() => /Starting/.test(document.querySelector("header .state")?.textContent ?? ""));
  assert.ok(await button(page, "Run").isDisabled());
  await picture("starting");
  await ready(page);
  await page.waitForSelector(".node");
  const tree = Date.now() - began;
  await button(page, "Run").click();
  await page.waitForSelector(".node[data-status=RUNNING]");
  const cold = Date.now() - began;
  await says(page, /Running: [1-9]/);
  await page.waitForSelector(".try .cm-line .runs");
  await picture("running");
  await button(page, "Stop").click();
  await says(page, /^Stopped after/);
  assert.ok(await button(page, "Stop").isDisabled());
  await page.waitForFunction(() => !document.querySelector(".node[data-status=RUNNING]"));

  // A mistake, its fix, and the run.
  await example(page, "A mistake to fix");
  await page.waitForSelector(".try .cm-lintRange-error");
  await page.waitForSelector(".try .tree.stale");
  await picture("mistake");
  await accessible(page, "mistake");
  await page.locator(".messages .fix").click();
  await page.waitForSelector(".messages .fine");
  assert.deepEqual((await shown(page)).slice(-2), ["go to kitchen", 'say "Breakfast is ready."']);
  await page.waitForFunction(() => /^go to kitchen\n/.test(document.querySelector(".reading pre").textContent));
  await page.selectOption("select[aria-label=Speed]", { label: "Fastest" });
  await page.keyboard.press("Control+Enter");
  await says(page, /^The mission succeeded/);
  for (const words of ["arrives at kitchen", "says “Breakfast is ready.”"]) await page.locator(".log li", { hasText: words }).waitFor();
  const drawn = await page.$eval(".map", (map) => new Set(map.getContext("2d").getImageData(0, 0, map.width, map.height).data).size);
  assert.ok(drawn > 20, "the map is empty");
  await picture("succeeded");

  // A mission without an end: the page answers while it runs, and it can be stopped.
  await example(page, "A mission without an end");
  await read(page);
  await button(page, "Run").click();
  await says(page, /Running: \d\d/);
  await replace(page, "go to the kitchn");
  await page.waitForSelector(".messages .fix");
  await says(page, /Running: \d{3}/);
  await button(page, "Stop").click();
  await says(page, /^Stopped after/, 5);

  // Keys, in 50 lines.
  await replace(page, FIFTY);
  await page.waitForSelector(".messages .fine");
  await page.waitForTimeout(1000);
  await page.keyboard.press("Control+End");
  await page.evaluate(() => {
    window.times = [];
    let pressed = 0;
    addEventListener("keydown", () => (pressed = performance.now()), true);
    new MutationObserver(() => document.querySelector(".try .tree").ariaBusy === "false" && pressed && window.times.push(performance.now() - pressed)).observe(document.querySelector(".try .tree"), { attributeFilter: ["aria-busy"] });
  });
  for (const key of "\nwave and nod\nwait 3 s\n") {
    await page.keyboard.press(key === "\n" ? "Enter" : key);
    await read(page);
    await page.waitForTimeout(30);
  }
  const keys = await page.evaluate(() => window.times);
  assert.ok(keys.length > 15, `${keys.length} keys`);

  // What is too long, and a worker that hangs.
  await replace(page, "wave\n".repeat(5000));
  await page.waitForFunction(() => /up to 20,000 characters/.test(document.querySelector(".try .problem").textContent));
  await button(page, "Share").click();
  await page.waitForFunction(() => /too long for a link/.test(document.querySelector(".try .problem").textContent));
  await replace(page, "repeat forever: wave");
  await page.waitForSelector(".messages .fine");
  await button(page, "Run").click();
  await says(page, /Running/);
  await page.waitForTimeout(300);
  void page.workers()[0].evaluate(() => { for (;;); }).catch(() => undefined);
  await button(page, "Stop").click();
  await page.waitForFunction(() => /started again/.test(document.querySelector(".try .problem").textContent), null, { timeout: 20_000 });
  await says(page, /^Ready/);

  await replace(page, `if ${"not ".repeat(4000)}the battery is low, wave`); // too deep for the stack of a browser
  await page.waitForFunction(() => /too much for the playground/.test(document.querySelector(".try .problem").textContent), null, { timeout: 60_000 });
  await says(page, /^Ready/);
  await page.waitForTimeout(1000);
  assert.match(await page.textContent(".try .problem"), /too much for the playground/);
  await replace(page, "wave");
  await page.waitForSelector(".messages .fine");

  // By a link: nothing runs, and nothing of it is markup.
  await replace(page, `say "Hello" # ${MARKUP}`);
  await page.waitForSelector(".messages .fine");
  await button(page, "Share").click();
  await says(page, /was copied/);
  const link = page.url();
  assert.match(link, /#mission=[\w-]+$/);
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), link);
  const guest = await context.newPage();
  await guest.goto(link);
  await ready(guest);
  await guest.waitForSelector(".node");
  assert.equal(await written(guest), `say "Hello" # ${MARKUP}`);
  await guest.waitForTimeout(500);
  assert.ok(await button(guest, "Stop").isDisabled(), "it runs without a click");
  await button(guest, "Run").click();
  await says(guest, /^The mission succeeded/);
  await replace(guest, `go to "${MARKUP}"`);
  await guest.locator(".messages .error", { hasText: "<img" }).first().waitFor();
  assert.deepEqual(await guest.evaluate(() => [document.images.length, window.hit]), [0, undefined]);
  for (const broken of ["#mission=AAAA", "#mission=%3Cimg%3E", `#mission=${"A".repeat(40_000)}`]) {
    await guest.goto("about:blank");
    await guest.goto(`${base}/try_it.html${broken}`);
    await guest.waitForFunction(() => /can be read/.test(document.querySelector(".try .problem")?.textContent ?? ""));
  }
  await guest.close();

  // A question, the help, dark, and a phone.
  await replace(page, 'ask "Tea or coffee?"');
  await read(page);
  await button(page, "Run").click();
  await page.waitForSelector(".question form:not([hidden])");
  await page.fill(".question input", "tea");
  await page.keyboard.press("Enter");
  await says(page, /^The mission succeeded/);
  await button(page, "Help").click();
  await page.getByRole("dialog").getByText("What it can't do").waitFor();
  await accessible(page, "help");
  await picture("help");
  await page.keyboard.press("Escape");
  await button(page, "Light or dark").click();
  await example(page, "Patrol");
  await read(page);
  await page.waitForTimeout(500);
  await accessible(page, "dark");
  await picture("dark");
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(300);
  await fits(page);
  await picture("phone");
  await page.screenshot({ path: `${pictures}/phone_whole.png`, fullPage: true });

  const loaded = [...sizes.values()].reduce((sum, size) => sum + size, 0);
  console.log(JSON.stringify({ tree, cold, key: Math.round(median(keys)), slowest: Math.round(Math.max(...keys)), loaded }));
  assert.ok(cold < COLD, `the first run after ${cold} ms`);
  assert.ok(median(keys) < KEY, `${median(keys)} ms from a key to the tree`);
}, {}, /fatal.error|RangeError/i);
