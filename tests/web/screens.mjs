// Every screen, with the mouse and with the keyboard, in two languages and both themes. Pictures go into a folder.
import assert from "node:assert/strict";
import { accessible, downloaded, fits, logIn, replace, submit, understood, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);
const NARROW = { width: 360, height: 740 };
const WIDE = { width: 1280, height: 800 };

await visit(base, async (page) => {
  const until = (text, where = "main") => page.waitForFunction(([text, where]) => [...document.querySelectorAll(where)].some((each) => each.textContent.includes(text)), [text, where]);
  const current = () => page.evaluate(() => document.getElementById(document.querySelector("[role=tree]").getAttribute("aria-activedescendant"))?.getAttribute("aria-label"));
  const look = async (name) => {
    for (const theme of ["dark", "light"]) {
      for (const size of [NARROW, WIDE]) {
        await page.evaluate((theme) => (document.documentElement.dataset.theme = theme), theme);
        await page.setViewportSize(size);
        await page.waitForTimeout(300);
        await fits(page);
        await page.screenshot({ path: `${pictures}/${name}_${theme}_${size.width}.png` });
        await accessible(page, `${name}, ${theme}, ${size.width}`);
      }
    }
  };

  await page.goto(base);
  await page.fill("[name=name]", "olga");
  await page.fill("[name=password]", "a wrong one");
  await page.click("form button");
  await until("The name or the password is wrong.");
  await look("log_in");
  await logIn(page, base, "ed", password);
  await look("robots");

  // Why a mission failed, with its words.
  await page.click(".robots a");
  await submit(page, "wave");
  await submit(page, "# It can't work.\nwave\nsay hello then fail");
  await until("say hello then fail", ".failure mark");
  await look("failure");

  // The tree, by keys alone.
  await submit(page, "repeat 2 times: wave then nod\nif the battery is low then say \"Help\"\ngo to the cafe\nwait 10 minutes");
  await until("go to cafe", ".running");
  await page.focus("[role=tree]");
  await page.keyboard.press("Home");
  assert.match(await current(), /^then, running/);
  await page.keyboard.press("ArrowRight");
  assert.match(await current(), /^repeat 2 times/);
  await page.keyboard.press("ArrowLeft");
  assert.equal(await page.getAttribute(".node[aria-selected=true]", "aria-expanded"), "false");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  assert.match(await current(), /^then/);
  await page.keyboard.press("End");
  assert.match(await current(), /wait/);
  await page.keyboard.type("go");
  assert.match(await current(), /go to cafe/);
  await page.keyboard.press("/");
  await page.keyboard.type("nod");
  await page.keyboard.press("Enter");
  assert.match(await current(), /nod/);
  await until("1/1", ".count");
  await until("nod", ".film-text mark.chosen");
  await page.click(".toolbar button[aria-pressed]");
  await page.waitForSelector(".node .port");
  await page.click(".toolbar button[aria-label='Turn the tree']");
  await page.click(".toolbar button[aria-label='Fit into the window']");
  await look("watch");
  await page.click(".controls button");
  await until("Go on", ".controls");
  await until("Paused", ".pill");
  await page.click(".controls button");
  await until("Pause", ".controls");

  // The queue and a schedule.
  await page.click(".tabs a[href$='/tasks']");
  await page.waitForSelector(".submit");
  for (const words of ["wave", "nod"]) {
    await page.fill(".submit textarea", words);
    await page.click(".submit .primary");
    await until("is queued", ".submit .said");
    await until(words, ".tasks .what");
  }
  await page.click("button[aria-label='Earlier: nod']");
  await page.waitForFunction(() => [...document.querySelectorAll("ol.tasks .what")].map((each) => each.textContent).join().endsWith("nod,wave"));
  await page.fill(".submit textarea", "wave");
  await page.fill(".submit input", "every day at 25:00");
  await page.click(".submit .primary");
  await page.waitForFunction(() => document.querySelector(".submit .problem").textContent);
  await page.fill(".submit input", "every day at 9:00");
  await page.click(".submit .primary");
  await until("every day at", "ul.tasks .pill");
  await look("tasks");
  await page.click("button[aria-label^='Remove']");
  await until("There are no schedules.");
  for (const words of ["wave", "nod"]) await page.click(`ol.tasks button[aria-label='Cancel: ${words}']`);
  await page.waitForFunction(() => document.querySelectorAll("ol.tasks > .card").length === 1);

  await page.click(".tabs a[href$='/runs']");
  await until("cancelled", ".pill");
  await look("look_back");
  await page.click(".tabs a[href$='/write']");
  await page.waitForSelector(".page ul");
  await page.goBack();
  await page.getByRole("link", { name: "Compare …" }).first().click();
  await until("Choose the run to compare it with.");
  await look("compare_choose");
  await page.getByRole("link", { name: "Compare with this" }).first().click();
  await until("The missions aren't the same", ".summary");
  await look("compare");
  await page.click(".tabs a[href$='/runs']");
  await page.locator("li", { hasText: "It can't work." }).getByRole("link", { name: "Replay" }).click();
  await page.waitForSelector(".film .outcome.bad");
  assert.equal(await page.textContent(".film-text mark"), "fail");
  assert.doesNotMatch(await page.innerText(".outcome"), /\^\^|AlwaysFailure|:\d+:\d+/, "a message for a terminal is in the page");
  assert.match(await page.innerText(".outcome"), /Line 3: .*fail/);
  await look("film");

  // What failed in all its runs.
  await page.click(".tabs a[href*='/robots/']:not([href$='/tasks'])");
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.click(".tabs a[href$='/runs']");
  await page.locator("li", { hasText: "It can't work." }).getByRole("button", { name: "Again" }).click();
  await page.waitForFunction(() => [...document.querySelectorAll("ol.tasks li:has(.pill.bad)")].filter((each) => each.textContent.includes("It can't work.")).length === 2);
  await page.locator("li", { hasText: "It can't work." }).getByRole("link", { name: "Replay" }).first().click();
  await page.getByRole("button", { name: "Failures of all runs" }).click();
  await until("fail: 2/2", ".often");
  await page.waitForSelector(".node.often4");
  await look("failures");
  await page.getByRole("button", { name: "Failures of all runs" }).click();
  await page.waitForSelector(".node.often4", { state: "detached" });
  for (const [kind, ending, begins] of [["MCAP", "mcap", "\x89MCAP0"], ["XML of BehaviorTree.CPP", "xml", "<?xml"], ["English", "txt", "# It can't"], ["SVG", "svg", "<svg"], ["PNG", "png", "\x89PNG"]]) {
    const [name, content] = await downloaded(page, kind);
    assert.match(name, new RegExp(`^It-can-t-work-\\d{4}-\\d\\d-\\d\\d-\\d{6}\\.${ending}$`));
    assert.equal(content.toString("latin1", 0, begins.length), begins);
    if (ending === "svg") {
      assert.match(content.toString(), /data-status="FAILURE"/);
      assert.doesNotMatch(content.toString(), /var\(|href|url\(/);
    }
  }
  await page.click(".tabs a[href$='/write']");
  await page.evaluate(() => (location.hash = "#/write/tour"));
  await page.waitForSelector(".cm-content[contenteditable=true]");
  await page.click(".cm-content");
  await page.keyboard.insertText("wave then ndo");
  await until("ndo", ".messages");
  await look("write");
  await replace(page, 'say "\\<script>alert(1)\\</script>\u202e" then wave');
  await understood(page);
  const [name, picture] = await downloaded(page, "SVG");
  assert.match(name, /^tour-.*\.svg$/);
  assert.match(picture.toString(), /&lt;script&gt;/);
  assert.match((await downloaded(page, "XML of BehaviorTree.CPP"))[1].toString(), /<Wave\/>/);

  // Tests of the mission: one passes, one fails, and one isn't understood.
  await replace(page, "wave\ncheck that the battery is low");
  await understood(page);
  await page.getByRole("button", { name: "Tests", exact: true }).click();
  await until('run "tour"', ".tests .cm-content");
  const tests = async (text) => {
    await page.click(".tests .cm-content");
    await page.keyboard.press("Control+A");
    await page.keyboard.insertText(text);
    await page.keyboard.press("Control+Enter");
  };
  await tests('test "it waves":\n  run "tour"\n  within 5 s it has done "wave"\n\ntest "it works":\n  run "tour"\n  finally the mission succeeds\n');
  await until("1 of 2 passed", ".results");
  await page.getByRole("button", { name: "Show its words" }).click();
  await until("battery is low", ".desk .chosen");
  await look("tests");
  await page.getByRole("button", { name: "Replay" }).click();
  await page.waitForSelector(".dialog .film .outcome.bad");
  await page.keyboard.press("Escape");
  await page.getByRole("button", { name: "Save the tests" }).click();
  await until("Saved", ".tests .state");
  await page.reload();
  await page.getByRole("button", { name: "Go on with it" }).click();
  await page.getByRole("button", { name: "Tests", exact: true }).click();
  await until("it waves", ".tests .cm-content");
  await tests('test "<script>":\n  run "tour"\n  frobnicate');
  await until("BT010", ".results");

  // Another language, and somebody who leaves.
  await page.click(".user");
  await page.keyboard.press("ArrowDown"); // the commands come first
  await page.keyboard.press("Enter");
  await until("Zusehen", ".tabs");
  await page.click(".user");
  await page.click("[role=menuitem]:last-child");
  await page.waitForSelector("[name=password]");
});
