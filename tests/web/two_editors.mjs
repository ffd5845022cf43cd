// Two editors of one mission: the stale save shows both versions, and nothing is lost.
import { end, faults, launch, logIn, open, picture, until, write, written } from "./browser.mjs";

const [base, password] = process.argv.slice(2);
const [browser, second] = [await launch(), await launch()]; // each with cookies of its own
const expected = /409/; // a browser notes that there is no such mission yet, and the refusal of a stale save
const [one, other] = [await open(browser, base, { expected }), await open(second, base, { expected })];
for (const [page, name] of [[one, "ed"], [other, "ann"]]) await logIn(page, base, name, password, "#/robots/robot");
for (const page of [one, other]) await page.goto(`${base}/#/write/shared`);
await write(one, 'say "one".');
await write(other, 'say "other".');
await save(one);
await saved(one);
await save(other);
await other.waitForSelector(".merge .cm-content");
await picture(other, "merge");
const sides = await other.$$eval(".merge .cm-content", (each) => each.map((side) => side.textContent));
if (!sides[0].includes("one") || !sides[1].includes("other")) faults.push(`merge: ${sides}`);
await other.click("dialog .primary");
await other.waitForSelector("dialog", { state: "detached" });
if (!(await written(other)).includes("other")) faults.push("the second editor's words are lost");
await save(other);
await saved(other);
await one.reload();
await one.waitForSelector(".cm-content");
await until(one, () => document.querySelector(".cm-content").textContent.includes("other"));
await second.close();
await end(browser);

async function save(page) {
  await page.click('button:text-is("Save")');
}

async function saved(page) {
  await until(page, () => document.querySelector(".desk .state").textContent === "Saved");
}
