// Two people write one mission: a stale save shows both versions, and nothing is lost. Then the link is cut: nor is a draft.
import assert from "node:assert/strict";
import { accessible, logIn, replace, visit, written } from "./browser.mjs";

const [base, password] = process.argv.slice(2);
const save = (page) => page.click('button:text-is("Save")');
const saved = (page) => page.waitForFunction(() => document.querySelector(".desk .state")?.textContent === "Saved");

const company = (page, wanted) => page.waitForFunction((wanted) => document.querySelector(".company")?.textContent === wanted, wanted);

async function enter(page, name) {
  page.on("dialog", (dialog) => void dialog.accept()); // leaving with a draft asks first
  await logIn(page, base, name, password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await page.evaluate(() => (location.hash = "#/write/shared"));
}

await visit(base, async (one) => {
  await enter(one, "ed");
  await visit(base, async (other) => {
    await enter(other, "ann");

    // each sees the other before anybody saves
    await company(one, "ann has this open too.");
    await replace(other, "wave");
    await company(one, "ann is changing this too.");
    await company(other, "ed has this open too.");
    await one.click('button[aria-label="1 other person is here: ann"]');
    await one.waitForSelector('[role=menuitem]:text-is("ann · changes “shared”")');
    await accessible(one, "people");
    await one.keyboard.press("Escape");
    const window = await one.context().newPage();
    await window.goto(`${base}/#/write/shared`);
    await company(one, "ann is changing this too. You have this open in another window.");
    await window.close();
    await company(one, "ann is changing this too.");

    await replace(one, 'say "one".');
    await replace(other, 'say "other".');
    await save(one);
    await saved(one);
    await save(other);
    await other.waitForSelector(".merge .cm-content");
    const sides = await other.$$eval(".merge .cm-content", (each) => each.map((side) => side.textContent));
    assert.match(sides[0], /one/);
    assert.match(sides[1], /other/);
    await other.click("dialog .primary");
    await other.waitForSelector("dialog", { state: "detached" });
    assert.match(await written(other), /other/);
    await save(other);
    await saved(other);
  });
  await company(one, "");
  await one.reload();
  await one.waitForFunction(() => document.querySelector(".panes .text .cm-content")?.textContent.includes("other"));

  await one.context().setOffline(true);
  await replace(one, 'say "offline".');
  await save(one);
  await one.waitForFunction(() => [...document.querySelectorAll(".problem")].some((each) => each.textContent.includes("kept in this browser")));
  await one.context().setOffline(false);
  await one.reload();
  await one.click(".offered .primary");
  assert.match(await written(one), /offline/);
  await save(one);
  await saved(one);
});
