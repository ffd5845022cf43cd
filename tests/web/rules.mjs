// A robot with house rules and a component: its missions keep their words live, in the replay and beside another run.
import assert from "node:assert/strict";
import { accessible, logIn, submit, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);
const MISSION = 'brew tea\ntry up to 2 times: check that the battery is low\notherwise say "it is full"\nif the battery is low then say "Help" otherwise say "good"\ngo to the lab\nwait 10 minutes';
const XML = '<root BTCPP_format="4"><BehaviorTree ID="Tea"><KeepRunningUntilFailure><Sequence><Wave/><BatteryLow/></Sequence></KeepRunningUntilFailure></BehaviorTree></root>';

await visit(base, async (page) => {
  const until = (text, where) => page.waitForFunction(([text, where]) => [...document.querySelectorAll(where)].some((each) => each.textContent.includes(text)), [text, where]);
  const words = () => page.$$eval(".node .words", (all) => all.map((each) => each.textContent));
  const states = () => page.$$eval(".rules li", (all) => all.map((each) => each.className));
  const inEnglish = async () => {
    const found = await words();
    assert.ok(found.length > 5, String(found));
    for (const each of found) assert.doesNotMatch(each, /[a-z][A-Z]|=|[{}]/, "an id or a port is in the words of a node");
    for (const wanted of ["brew tea", "try up to 2 times", "if … then … otherwise"]) assert.ok(found.some((each) => each.endsWith(wanted)), `${wanted}: ${found}`);
    assert.ok(!found.some((each) => /whenever/i.test(each)), "the house rules are in the tree of the mission");
  };
  const noAlarm = async () => {
    const [no, alarm] = await page.evaluate(() => {
      const box = document.querySelector('.node[data-answer="FALSE"] rect');
      const { stroke } = getComputedStyle(box);
      box.style.transition = "none";
      box.style.stroke = "var(--failure)";
      const alarm = getComputedStyle(box).stroke;
      box.style.stroke = "";
      return [stroke, alarm];
    });
    assert.notEqual(no, alarm, "a condition that is false looks like a failure");
  };

  await logIn(page, base, "ann", password);
  await page.click(".robots a");
  await page.waitForSelector(".rules li.armed");
  assert.equal(await page.isVisible(".watch .empty"), true, "the rules are shown as a mission");
  await submit(page, MISSION);
  await until("go to lab", ".running");
  await inEnglish();
  assert.deepEqual(await states(), ["armed", "armed"]);
  assert.match(await page.textContent(".pill"), /At work/);
  await noAlarm();
  await page.click(".toolbar button[aria-pressed]"); // ids on demand
  await until("RetryUntilSuccessful", ".node .port");
  await page.click(".toolbar button[aria-pressed]");
  await page.waitForSelector(".rules li.doing");
  assert.deepEqual(await states(), ["doing", "waiting"]);
  await page.waitForSelector(".pill.quiet");
  await accessible(page, "rules");
  await page.screenshot({ path: `${pictures}/rules_live.png` });
  await page.click(".rules button");
  await until("whenever", ".node .words");
  await page.click(".rules button");
  await page.waitForFunction(() => ![...document.querySelectorAll(".node .words")].some((each) => /whenever/.test(each.textContent)));
  await page.click(".stop");
  await page.waitForSelector(".latch");
  await page.click(".release");
  await page.waitForSelector(".latch", { state: "detached" });

  await submit(page, MISSION);
  await page.waitForSelector(".rules li.doing"); // it's at the lab still
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.click(".tabs a[href$='/runs']");
  await page.waitForFunction(() => document.querySelectorAll(".tasks li").length === 2);
  await page.locator("li", { hasText: "killed" }).getByRole("link", { name: "Replay" }).click();
  await page.waitForSelector(".film .outcome.bad:has-text('emergency stop')");
  assert.equal((await page.textContent("h1")).trim(), "brew tea");
  assert.equal((await page.textContent(".film-text")).trim(), MISSION);
  await inEnglish();
  const length = Number(await page.getAttribute(".timeline input", "max"));
  await page.fill(".timeline input", String(length));
  await page.waitForSelector(".node[data-answer=FALSE]");
  await noAlarm();
  assert.ok((await page.$$eval(".rules li", (all) => all.map((each) => each.textContent))).some((each) => each.includes("whenever the robot is at the lab")));
  await accessible(page, "rules, replay");
  await page.screenshot({ path: `${pictures}/rules_replay.png` });

  await page.getByRole("link", { name: "Compare …" }).click();
  await page.getByRole("link", { name: "Compare with this" }).click();
  await page.waitForSelector(".compared .sides");
  assert.deepEqual(await page.$$eval(".one h2 span", (all) => all.map((each) => each.textContent)), ["brew tea", "brew tea"]);
  assert.deepEqual(await page.$$eval(".one .film-text", (all) => all.map((each) => each.textContent)), [MISSION, MISSION]);
  assert.equal(await page.$$eval(".one .rules li", (all) => all.length), 4);
  assert.match(await page.textContent(".summary .first"), /at lab: false/);
  assert.doesNotMatch(await page.textContent(".summary"), /FAILURE|SUCCESS/);
  await page.screenshot({ path: `${pictures}/rules_compared.png` });

  await page.click(".tabs a[href*='/robots/']:not([href$='/tasks'])"); // a tree in XML, too
  await submit(page, XML);
  await until("Failed at battery is low", ".failure");
  const [live, log] = [await words(), await page.textContent(".log")];
  assert.ok(live.some((each) => each.endsWith("again and again until it fails")), String(live));
  assert.equal(log.split("the mission was ended").length, 3, "the rules between missions are a mission");
  await page.click(".tabs a[href$='/runs']");
  await page.locator("li", { hasText: "battery is low: it is not true" }).getByRole("link", { name: "Replay" }).click();
  await page.waitForSelector(".film .outcome.bad");
  assert.deepEqual((await words()).sort(), live.sort());
  assert.equal((await page.textContent("h1")).trim(), "Tea");
  assert.equal(await page.$$eval(".rules li", (all) => all.length), 2);
  await page.click(".rules button");
  await until("whenever", ".node .words");
  await page.click(".rules button");
  await page.waitForFunction(() => ![...document.querySelectorAll(".node .words")].some((each) => /whenever/.test(each.textContent)));
});
