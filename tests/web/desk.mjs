// The editor: three missions to begin with, messages with their place and fixes, a toolbar that stays, a trial beside the text.
import assert from "node:assert/strict";
import { accessible, logIn, replace, understood, untilWritten, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);
const LONG = Array.from({ length: 300 }, (_, number) => `say "number ${number}" then wave`).join("\n");
const COLOURED = '# A greeting\ngreet is say "Hi"\nif the battery is below 30%, greet 2 times otherwise nod\n';

await visit(base, async (page) => {
  await page.setViewportSize({ width: 1440, height: 900 });
  await logIn(page, base, "ed", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await page.evaluate(() => (location.hash = "#/write/begin"));
  await page.waitForFunction(() => document.querySelectorAll(".starter").length === 3);
  await page.waitForSelector(".start .map");
  assert.equal(await page.$$eval(".messages .error", (all) => all.length), 0, "an empty mission is a mistake");
  await accessible(page, "three missions to begin with");
  await page.screenshot({ path: `${pictures}/desk_start.png` });
  const buttons = () => page.$$eval(".desk > .head .controls button", (all) => all.map((each) => [each.textContent, Math.round(each.getBoundingClientRect().left), each.classList.contains("primary")]));
  const before = await buttons();
  assert.ok(before.length <= 5, String(before));
  assert.equal(before.filter(([, , primary]) => primary).length, 1);
  await page.click(".starter");
  await understood(page);
  assert.ok(await page.isHidden(".start"));

  // Messages say where, and what to do; the buttons stay where they are.
  await replace(page, "wave\ngo to the caffe\nwave");
  await page.waitForSelector(".messages .error:has-text('Line 2')");
  assert.doesNotMatch(await page.innerText(".messages"), /\^|<text>|BT\d/);
  assert.deepEqual(await buttons(), before, "the toolbar jumps");
  await page.getByRole("button", { name: "Run on the robot" }).click();
  await page.waitForSelector(".stage > .problem:has-text('Line 2')");
  assert.doesNotMatch(await page.innerText(".stage > .problem"), /\^\^|error BT/, "a message for a terminal is in the page");
  await accessible(page, "messages");
  await page.screenshot({ path: `${pictures}/desk_messages.png` });
  await page.click(".messages .fix");
  await untilWritten(page, "wave\ngo to the cafe\nwave");
  await understood(page);

  // Words have the colours of what they are read as, in both themes; what is written has them when nobody types.
  await replace(page, COLOURED);
  await page.waitForSelector(".token-comment");
  const coloured = (kind) => page.$$eval(`.token-${kind}`, (all) => all.map((each) => each.textContent.trim()));
  assert.deepEqual([await coloured("name"), await coloured("text"), await coloured("number")], [["greet", "greet"], ['"Hi"'], ["30", "2"]]);
  assert.deepEqual(await coloured("word"), ["is", "if", "times", "otherwise"]);
  for (const theme of ["dark", "light"]) {
    await page.evaluate((theme) => (document.documentElement.dataset.theme = theme), theme);
    await accessible(page, `colours, ${theme}`);
    await page.screenshot({ path: `${pictures}/desk_colours_${theme}.png` });
  }
  await page.keyboard.press("Control+Home");
  await page.keyboard.type("wave then nod\n", { delay: 5 });
  await page.waitForFunction(() => [...document.querySelectorAll(".token-word")].some((each) => each.textContent === "then"));
  await page.keyboard.press("Control+End");
  await page.keyboard.type("go to", { delay: 5 });
  await page.waitForSelector(".cm-tooltip-autocomplete li[aria-selected]:has-text('to cafe')");
  await page.keyboard.press("Escape"); // no completion
  await replace(page, "wave\ngo to the cafe\nwave");
  await understood(page);

  // The trial stands beside the text, in which what runs is lit.
  await page.getByRole("button", { name: "Try in simulation" }).click();
  await page.waitForSelector(".trial .film");
  assert.ok(await page.isVisible(".panes .text .cm-content"));
  const lit = (words) => page.waitForFunction((words) => [...document.querySelectorAll(".cm-content :is(.runs, .chosen)")].map((each) => each.textContent).join() === words, words);
  await lit("wave");
  await page.locator(".trial .story button", { hasText: "go to cafe" }).click();
  await lit("go to the cafe");
  await accessible(page, "a trial");
  await page.screenshot({ path: `${pictures}/desk_trial.png` });
  await page.getByRole("button", { name: "Close" }).click();
  await page.waitForSelector(".trial", { state: "hidden" });

  // Of a long text only what differs is sent behind a key.
  const sizes = [];
  page.on("response", async (response) => response.url().endsWith("/api/document") && sizes.push((await response.body()).length));
  await replace(page, LONG);
  await understood(page);
  await page.keyboard.press("Control+Home");
  for (const key of ["n", "o", "d", "Enter"]) {
    await page.keyboard.press("Escape"); // no completion
    await page.keyboard.press(key);
  }
  await understood(page);
  await page.waitForSelector(".node:has-text('nod')");
  const nodes = await page.$$eval(".outline option, .desk select option", (all) => all.length);
  assert.ok(nodes > 300, "the outline isn't whole");
  assert.ok(sizes.length > 1 && Math.min(...sizes) * 5 < Math.max(...sizes), `whole documents are sent: ${sizes}`);
});
