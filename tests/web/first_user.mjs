// A first user writes a mission with two mistakes, mends it, changes it by its tree, tries, keeps, runs and stops it.
import assert from "node:assert/strict";
import { accessible, fits, logIn, visit } from "./browser.mjs";

const [base, password] = process.argv.slice(2);

await visit(base, async (page) => {
  const text = () => page.evaluate(() => [...document.querySelectorAll(".text .cm-line")].map((line) => line.textContent).join("\n"));
  const untilText = (part) => page.waitForFunction((wanted) => [...document.querySelectorAll(".text .cm-line")].map((line) => line.textContent).join("\n").includes(wanted), part);
  const choose = (words) => page.locator(".node", { hasText: words }).first().click({ button: "right" });
  const command = (words) => page.getByRole("menuitem", { name: words }).click();

  await logIn(page, base, "ed", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");

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
  const wrapped = await text();
  assert.ok(wrapped.includes("  wave  # to all") && wrapped.includes("# Tea"), `comments in ${wrapped}`);
  await page.getByRole("button", { name: "Undo" }).click();
  await page.waitForFunction(() => !document.querySelector(".text .cm-content").textContent.includes("retry"));
  await page.getByRole("button", { name: "Redo" }).click();
  await untilText("retry 2 times:");
  await accessible(page, "write");

  // try it, keep it, run it
  await page.waitForSelector(".messages .fine");
  await page.getByRole("button", { name: "Try in simulation" }).click();
  await page.waitForSelector("dialog .film .outcome");
  assert.ok((await page.textContent("dialog .outcome")).includes("succeeded"), "a trial that succeeds");
  await page.getByRole("button", { name: "Close" }).click();
  await page.getByRole("button", { name: "Save" }).click();
  await page.waitForFunction(() => document.querySelector(".desk .state").textContent === "Saved");
  await page.getByRole("button", { name: "Run on the robot" }).click();
  await page.waitForSelector(".watch .running li");
  await page.waitForSelector(".node[data-status=RUNNING]");

  // stop it, and let it move again
  await page.click("button.stop");
  await page.waitForFunction(() => /stopped|confirmed/.test(document.querySelector(".stops").textContent));
  await page.getByRole("button", { name: "Let it move again" }).click();
  await page.waitForFunction(() => !document.querySelector(".stops button"));
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
});
