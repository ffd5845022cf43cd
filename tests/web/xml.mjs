// Trees in XML: opened in English, edited by text and tree. A file is saved onto itself, one in a robot's library as a copy.
import assert from "node:assert/strict";
import { accessible, fits, logIn, visit, written } from "./browser.mjs";

const [edited, base, password] = process.argv.slice(2);
const TREE = '<root BTCPP_format="4"><BehaviorTree ID="Tea"><Sequence><!-- hot --><Wave/><Nod/></Sequence></BehaviorTree></root>';
const saved = (page) => page.waitForFunction(() => document.querySelector(".desk .state")?.textContent === "Saved");

/** Wraps the nod in a retry, and saves. */
async function change(page) {
  await page.locator(".node", { hasText: "nod" }).first().click({ button: "right" });
  await page.getByRole("menuitem", { name: "Wrap in a form" }).click();
  await page.selectOption("dialog [name=form]", "within");
  assert.equal(await page.inputValue("dialog [name=words]"), "5 s");
  await page.fill("dialog [name=words]", "7 s");
  await page.selectOption("dialog [name=form]", "retry");
  assert.equal(await page.inputValue("dialog [name=words]"), "7 s");
  await page.fill("dialog [name=words]", "4");
  await page.click("dialog .primary");
  await page.locator(".node", { hasText: "Retry" }).first().waitFor();
  assert.match(await written(page), /# hot\n[^]*retry .*nod.* 4 times/);
  await page.click('button:text-is("Save")');
  await saved(page);
}

await visit(new URL(edited).origin, async (page) => {
  await page.goto(edited);
  await page.waitForSelector(".origin:not(:empty)");
  assert.match(await page.textContent(".origin"), /tree\.xml in English\. Saving changes tree\.xml/);
  await change(page);
  await accessible(page, "a tree in English");
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
});

await visit(base, async (page) => {
  await logIn(page, base, "ed", password);
  const csrf = await page.evaluate(() => fetch("/api/me").then((answer) => answer.json()).then(({ csrf }) => csrf));
  const put = (text) => page.evaluate(([text, csrf]) => fetch("/api/missions/brewing", { method: "PUT", headers: { "content-type": "application/json", "x-csrf-token": csrf }, body: JSON.stringify({ text, revision: 0 }) }).then(({ status }) => status), [text, csrf]);
  assert.equal(await put(TREE), 200);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await page.evaluate(() => (location.hash = "#/write/brewing"));
  await page.waitForSelector(".origin:not(:empty)");
  assert.equal(await page.textContent(".desk h1"), "brewing in English");
  await change(page);
  // opened again, it is the mission that was saved
  await page.evaluate(() => (location.hash = "#/write"));
  await page.waitForSelector('a:text-is("brewing in English")');
  await page.click('a:text-is("brewing")');
  await page.waitForSelector(".origin:not(:empty)");
  assert.match(await written(page), /4 times/);
});
