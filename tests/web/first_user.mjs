// A first user writes a mission with two mistakes, mends it, runs and stops it, changes it by its tree, tries it, keeps and
// schedules it, and finds out why yesterday's mission failed. With folders for pictures, each step is compared.
import assert from "node:assert/strict";
import { accessible, fits, logIn, more, replace, understood, untilWritten, visit, written } from "./browser.mjs";
import { gallery } from "./golden.mjs";

const [base, password, golden, found] = process.argv.slice(2);
const WRONG = `# Tea for everybody
go to the caffe  # where the cups are
repeat look aruond 2 times
say "Tea is ready"
wait 60 s
`;

await visit(base, async (page) => {
  const untilText = (part) => untilWritten(page, part, { isPart: true });
  const fine = () => understood(page);
  const choose = async (words) => {
    await fine();
    await page.locator(".node", { hasText: words }).first().click({ button: "right" });
  };
  const command = (words) => page.getByRole("menuitem", { name: words }).click();
  const button = (words) => page.getByRole("button", { name: words, exact: true });

  // log in
  await page.goto(base);
  const look = await gallery(page, golden, found);
  await page.waitForSelector("[name=name]");
  await look("log_in");
  await logIn(page, base, "ed", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");

  // write the mission with two mistakes, and take the fixes
  await page.evaluate(() => (location.hash = "#/write/tea"));
  await replace(page, WRONG);
  await page.waitForFunction(() => document.querySelectorAll(".messages .error").length === 2);
  await page.waitForSelector(".token-number"); // colours come when nobody types
  await look("mistakes");
  for (const line of [1, 2]) {
    await page.keyboard.press("Control+Home");
    for (let down = 0; down < line; down++) await page.keyboard.press("ArrowDown");
    await page.keyboard.press("Control+."); // the second one before there are messages about what the first one made
  }
  for (const right of ["go to the cafe ", "repeat look around 2 times"]) await untilText(right);
  await fine();
  await look("mended");

  // watch it run, stop it, and let it move again
  await button("Run on the robot").click();
  await page.waitForSelector(".watch .running li");
  await page.waitForSelector(".node[data-status=RUNNING]");
  await look("running");
  await page.click("button.stop");
  await page.waitForFunction(() => /stopped|confirmed/.test(document.querySelector(".stops").textContent));
  await page.waitForSelector(".latch");
  await page.waitForFunction(() => !document.querySelector(".running li") && !document.querySelector(".alarm").textContent);
  await look("stopped");
  await button("Let it move again").click();
  await page.waitForFunction(() => !document.querySelector(".stops button"));

  // back to the draft: change a count, add a step from the palette, wrap two steps in a retry; take one back
  await page.evaluate(() => (location.hash = "#/write/tea"));
  await page.click(".offered .primary");
  await fine();
  await choose("2 times");
  await command("Change values");
  await page.fill("dialog [name=rounds]", "3");
  await page.click("dialog .primary");
  await untilText("look around 3 times");
  await choose("Tea is ready");
  await command("Add after it");
  await page.fill("dialog input", "wave");
  await look("palette");
  await page.click(".offer");
  await page.click("dialog .primary");
  await untilText("\nwave\n");
  await choose("Tea is ready");
  await command("Wrap in a form");
  await page.fill("dialog [name=words]", "2");
  await page.fill("dialog [name=count]", "2");
  await look("wrap");
  await page.click("dialog .primary");
  await untilText("retry 2 times:");
  const wrapped = await written(page);
  assert.ok(wrapped.includes("# Tea for everybody") && wrapped.includes("cafe  # where the cups are"), `comments in ${wrapped}`);
  assert.ok(wrapped.includes('  say "Tea is ready"\n  wave'), wrapped);
  await more(page, "Undo");
  await page.waitForFunction(() => !document.querySelector(".panes .text .cm-content").textContent.includes("retry"));
  await more(page, "Redo");
  await untilText("retry 2 times:");
  await fine();
  await accessible(page, "write");
  await look("changed");

  // what a text says is never read as markup
  await page.keyboard.press("Control+End");
  await choose("wave");
  await command("Add after it");
  await page.fill("dialog input", "say \"\\<script>alert(1)\\</script> \u202etea\"");
  await page.click("dialog .primary");
  await untilText("alert(1)");
  await more(page, "Undo");
  await page.waitForFunction(() => !document.querySelector(".panes .text .cm-content").textContent.includes("alert"));

  // try it, keep it, schedule it for tomorrow
  await fine();
  await button("Try in simulation").click();
  await page.waitForSelector(".trial .film .outcome");
  assert.ok((await page.textContent(".trial .outcome")).includes("succeeded"), "a trial that succeeds");
  await button("Close").click();
  await more(page, "Schedule …");
  await page.waitForFunction(() => [...document.querySelectorAll(".problem")].some((each) => each.textContent.includes("Save it first")));
  await button("Save").click();
  await page.waitForFunction(() => document.querySelector(".desk .state").textContent === "Saved");
  await more(page, "Schedule …");
  await page.fill("dialog [name=time]", "08:30");
  await look("schedule");
  await page.click("dialog .primary");
  await page.waitForFunction(() => /^Scheduled: on .* at 0?8:30/.test(document.querySelector(".desk .state").textContent));
  await page.click(".tabs a[href$='/tasks']");
  await page.waitForFunction(() => document.querySelector("ul.tasks .what")?.textContent === "tea");
  const { next } = await page.evaluate(async () => {
    const asked = { method: "POST", headers: { "content-type": "application/json", "x-csrf-token": (await (await fetch("/api/me")).json()).csrf }, body: '{"command": "schedules"}' };
    return (await (await fetch("/api/commands", asked)).json()).data.schedules[0];
  });
  const [due, now] = [new Date(next * 1000), new Date()];
  assert.equal(due.toDateString(), new Date(now.getFullYear(), now.getMonth(), now.getDate() + 1).toDateString());
  assert.equal(`${due.getHours()}:${due.getMinutes()}`, "8:30");
  await page.click("ul.tasks button[aria-label='Remove: tea']");
  await page.waitForSelector("ul.tasks .empty");

  // yesterday's failure, and its words
  await page.click(".tabs a[href$='/runs']");
  const failed = page.locator("li", { hasText: "Evening round" });
  await failed.getByText("failed", { exact: true }).waitFor();
  await look("look_back");
  await failed.getByRole("link", { name: "Replay" }).click();
  await page.waitForSelector(".film .outcome.bad");
  assert.equal(await page.textContent(".film-text mark"), "go to the cafe within 3 s");
  await look("failure");
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
});
