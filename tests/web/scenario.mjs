// A first user, in a browser: node scenario.mjs ADDRESS NAME PASSWORD [FOLDER for pictures]. Prints JSON: what went wrong.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import chromium from "@sparticuz/chromium";
import { chromium as browsers } from "playwright-core";

const [address, name, password, pictures] = process.argv.slice(2);
const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const browser = await browsers.launch({ args: [...chromium.args, "--no-sandbox"], executablePath: await chromium.executablePath(), headless: true });
const context = await browser.newContext({ ignoreHTTPSErrors: true, bypassCSP: false, locale: "en-GB", viewport: { width: 1280, height: 800 } });
const page = await context.newPage();
page.setDefaultTimeout(20_000);
const problems = [];
let step = 0;

page.on("pageerror", (error) => problems.push(`error: ${error.message}`));
page.on("console", (message) => message.type() === "error" && !/401/.test(message.text()) && problems.push(`console: ${message.text()}`));
page.on("request", (request) => !request.url().startsWith(address) && !/^(data|blob):/.test(request.url()) && problems.push(`request to ${request.url()}`));
page.on("dialog", (dialog) => { problems.push(`dialog: ${dialog.message()}`); void dialog.dismiss(); });

async function done(what) {
  step += 1;
  if (pictures) await page.screenshot({ path: `${pictures}/${step}-${what}.png` });
}

async function accessible(where) {
  const found = await page.evaluate(`${axe};axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) => violations.filter(({ impact }) => ["serious", "critical"].includes(impact)).map(({ id, nodes }) => id + " " + nodes[0].target))`);
  for (const each of found) problems.push(`${where}: ${each}`);
}

function expect(holds, what) {
  if (!holds) problems.push(`expected: ${what}`);
}

const text = () => page.evaluate(() => [...document.querySelectorAll(".text .cm-line")].map((line) => line.textContent).join("\n"));
const untilText = (part) => page.waitForFunction((wanted) => [...document.querySelectorAll(".text .cm-line")].map((line) => line.textContent).join("\n").includes(wanted), part);
const choose = (words) => page.locator(".node", { hasText: words }).first().click({ button: "right" });
const command = (words) => page.getByRole("menuitem", { name: words }).click();

await page.goto(address);
await page.fill("[name=name]", name);
await page.fill("[name=password]", password);
await accessible("log-in");
await done("log-in");
await page.click("form button");
await page.waitForSelector(".robots, .watch");
const robot = await page.locator(".robots a").first();
if (await robot.count()) await robot.click();
await page.waitForSelector(".watch canvas");

// write the mission with two mistakes, and take the fixes
await page.evaluate(() => (location.hash = "#/write/tea"));
await page.waitForSelector(".cm-content[contenteditable=true]");
await page.click(".cm-content");
await page.keyboard.insertText("# Tea\nwavee  # to all\nrepeat look aruond 2 times\nwait 60 s\n");
await page.waitForSelector(".messages .error");
for (const [line, right] of [[1, "wave  # to all"], [2, "look around"]]) {
  await page.keyboard.press("Control+Home");
  for (let down = 0; down < line; down++) await page.keyboard.press("ArrowDown");
  await page.waitForTimeout(100);
  await page.keyboard.press("Control+.");
  await untilText(right);
}
await page.waitForSelector(".messages .fine");
await done("fixed");

// change a count, add a step, wrap two steps in a retry; take one back
await choose("Repeat");
await command("Change values");
await page.fill("dialog [name=rounds]", "3");
await page.click("dialog .primary");
await untilText("look around 3 times");
await choose("Repeat");
await command("Add after it");
await page.fill("dialog input", "say \"<script>alert(1)</script> \u202etea\"");
await page.click("dialog .primary");
await untilText("alert(1)");
await choose("wave");
await command("Wrap in a form");
await page.fill("dialog [name=words]", "2");
await page.fill("dialog [name=count]", "2");
await page.click("dialog .primary");
await untilText("retry 2 times:");
await done("edited");
const wrapped = await text();
expect(wrapped.includes("  wave  # to all") && wrapped.includes("# Tea"), `comments in ${wrapped}`);
await page.getByRole("button", { name: "Undo" }).click();
await page.waitForFunction(() => !document.querySelector(".text .cm-content").textContent.includes("retry"));
await page.getByRole("button", { name: "Redo" }).click();
await untilText("retry 2 times:");
await accessible("write");

// try it, keep it, run it
await page.waitForSelector(".messages .fine");
await page.getByRole("button", { name: "Try in simulation" }).click();
await page.waitForSelector("dialog .film .outcome");
expect((await page.textContent("dialog .outcome")).includes("succeeded"), "a trial that succeeds");
await done("tried");
await page.getByRole("button", { name: "Close" }).click();
await page.getByRole("button", { name: "Save" }).click();
await page.waitForFunction(() => document.querySelector(".desk .state").textContent === "Saved");
await page.getByRole("button", { name: "Run on the robot" }).click();
await page.waitForSelector(".watch .running li");
await page.waitForSelector(".node[data-status=RUNNING]");
await accessible("watch");
await done("watched");

// stop it, and let it move again
await page.click("button.stop");
await page.waitForFunction(() => /stopped|confirmed/.test(document.querySelector(".stops").textContent));
await done("stopped");
await page.getByRole("button", { name: "Let it move again" }).click();
await page.waitForFunction(() => !document.querySelector(".stops button"));
await page.setViewportSize({ width: 360, height: 740 });
const wide = await page.evaluate(() => document.documentElement.scrollWidth);
expect(wide <= 360, `no sideways scrolling on a phone: ${wide} pixels`);
await done("phone");
await browser.close();
console.log(JSON.stringify(problems));
