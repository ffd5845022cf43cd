// People, zones, doors and questions at the page: live, in other colours, narrow, and in the recording.
import assert from "node:assert/strict";
import { accessible, fits, logIn, submit, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);
const MISSION = 'ask "Shall I close the door?" then if the answer is yes, (retry (wait 1 s then close the door) 100 times) then close the wet floor then wait 20 s';
const shot = (page, name) => page.screenshot({ path: `${pictures}/${name}.png`, fullPage: true });
const logged = (page, text) => page.waitForSelector(`.log li:has-text("${text}")`, { timeout: 60_000 }); // people may stand in the door

await visit(base, async (page) => {
  await logIn(page, base, "olga", password);
  await page.click(".robots a");
  await page.click("button:has-text('A visitor comes')");
  await logged(page, "visitor 1 comes");
  await submit(page, MISSION);
  await page.waitForSelector(".asks:has-text('Shall I close the door?')");
  await accessible(page, "question");
  await shot(page, "question");
  await page.emulateMedia({ colorScheme: "dark" });
  await shot(page, "dark");
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
  await shot(page, "narrow");
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.emulateMedia({ colorScheme: "light" });
  await page.click(".question button:has-text('Yes')");
  await logged(page, "hears “yes”");
  await logged(page, "door is closed");
  await logged(page, "sees ");
  await shot(page, "closed");
  await logged(page, "the mission succeeded");

  await page.click(".tabs a:has-text('Look back')");
  await page.click("button:has-text('Replay'), a:has-text('Replay')");
  await page.waitForSelector(".story li");
  const range = page.locator(".timeline input[type=range]");
  for (const [name, part] of [["begins", 0.1], ["ends", 1]]) {
    await range.evaluate((input, part) => {
      input.value = String(Number(input.max) * part);
      input.dispatchEvent(new Event("input", { bubbles: true }));
    }, part);
    await page.waitForTimeout(200);
    await shot(page, name);
  }
});

await visit(base, async (page) => {
  await logIn(page, base, "vic", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await page.waitForSelector(".pill:has-text('battery')"); // it knows what the robot says of itself
  assert.ok(!(await page.isVisible(".visitor")));
});
