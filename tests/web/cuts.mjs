// The server and the robot go while a mission is written, watched and given: nothing is lost, and people are told.
import assert from "node:assert/strict";
import { logIn, replace, submit, visit, written } from "./browser.mjs";

const [base, password, switchboard] = process.argv.slice(2);
const turn = async (name) => assert.equal((await fetch(`${switchboard}/${name}`, { method: "POST" })).status, 204);

await visit(base, async (page) => {
  page.on("dialog", (dialog) => void dialog.accept()); // leaving with a draft asks first
  const until = (text, where = "main") => page.waitForFunction(([text, where]) => [...document.querySelectorAll(where)].some((each) => each.textContent.includes(text)), [text, where]);
  const save = () => page.click('button:text-is("Save")');
  const connected = () => page.waitForFunction(() => document.querySelector(".cut")?.textContent === "");
  const open = (place) => page.evaluate((place) => (location.hash = place), place);

  await logIn(page, base, "ed", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await open("#/write/steady");
  await replace(page, 'say "before".');
  await save();
  await until("Saved", ".state");

  // The server goes while somebody writes: he goes on, and it's as before once the server is back.
  await turn("kill-server");
  await until("No connection to the server", ".cut");
  await replace(page, 'say "meanwhile" then ndo.');
  await save();
  await until("Not saved, but kept in this browser", ".problem");
  assert.match(await written(page), /meanwhile/);
  await turn("start-server");
  await connected();
  await until("ndo", ".messages .error");
  await replace(page, 'say "meanwhile" then nod.');
  await until("No problems found", ".messages");
  await page.waitForFunction(() => ![...document.querySelectorAll(".problem")].some((each) => each.textContent));
  await save();
  await until("Saved", ".state");

  // It goes, and with it the session: after the log-in the mission is open again, with its draft.
  await replace(page, 'say "the third one".');
  await turn("kill-server");
  await turn("log-out");
  await replace(page, 'say "the fourth one".');
  await turn("start-server");
  await page.fill("[name=name]", "ed");
  await page.fill("[name=password]", password);
  await page.click("form button");
  await page.click(".offered .primary");
  assert.match(await written(page), /the fourth one/);
  await save();
  await until("Saved", ".state");

  // The link is cut in the middle of a save: the server has it, but nobody said so. Nobody else has saved.
  await replace(page, 'say "cut in the middle".');
  await page.route("**/api/missions/**", async (route) => {
    await route.fetch();
    await route.abort("connectionreset");
  }, { times: 1 });
  await save();
  await until("Not saved, but kept in this browser", ".problem");
  await save();
  await until("Saved", ".state");
  assert.equal(await page.$(".merge"), null);
  await page.reload();
  await page.waitForFunction(() => document.querySelector(".panes .text .cm-content")?.textContent.includes("cut in the middle"));
  assert.equal(await page.$(".offered .primary"), null);

  // The server goes while a mission runs: the mission goes on, and the page sees its end.
  await page.click(".tabs a");
  await submit(page, 'wait 20 s then say "the end of it"');
  await page.waitForSelector(".node[data-status=RUNNING]");
  await turn("kill-server");
  await until("No connection to the server", ".cut");
  await turn("start-server");
  await connected();
  await until("Pause", ".controls");
  await until("the end of it", ".log, .says");
  await page.waitForFunction(() => document.querySelector(".node[data-status=SUCCESS]") && !document.querySelector(".running li"));

  // The robot goes while it's watched: nothing runs any more, and what is given to it is refused, and kept.
  await submit(page, "wait 10 minutes");
  await page.waitForSelector(".running li");
  await turn("kill-robot");
  await until("Away", ".pill");
  await until("can't be reached", ".gone");
  await page.waitForFunction(() => !document.querySelector(".running li"));
  assert.ok(await page.isDisabled(".controls button"));
  await page.click("summary");
  await page.fill(".submit textarea", "wave then nod");
  await page.click(".submit .primary");
  await until("isn't up, or doesn't answer", ".submit .problem");
  assert.equal(await page.inputValue(".submit textarea"), "wave then nod");
  await turn("start-robot");
  await page.waitForFunction(() => !document.querySelector(".pill").textContent.includes("Away") && !document.querySelector(".gone").textContent);
  await page.click(".submit .primary");
  await until("is queued", ".submit .said");
  await page.click(".tabs a[href$='/tasks']");
  await until("wave then nod", ".tasks");

  // It goes while a mission is written, checked, saved and run.
  await open("#/write/steady");
  await replace(page, 'say "without a robot".');
  await turn("kill-robot");
  await save();
  await until("Not saved, but kept in this browser", ".problem");
  await page.click('button:text-is("Run on the robot")');
  await until("isn't up, or doesn't answer", ".problem");
  assert.match(await written(page), /without a robot/);
  await page.reload();
  await until("Your draft is kept in this browser", ".problem");
  await turn("start-robot");
  await page.click(".offered .primary");
  assert.match(await written(page), /without a robot/);
  await save();
  await until("Saved", ".state");
}, {}, /status of (401|404|409|503)|ERR_(CONNECTION_(REFUSED|RESET)|INTERNET_DISCONNECTED)|WebSocket/);
