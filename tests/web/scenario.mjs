// Somebody logs in, watches a mission, stops the robot with and without a connection, and lets it move again.
import assert from "node:assert/strict";
import { accessible, fits, logIn, submit, visit } from "./browser.mjs";

const [base, password] = process.argv.slice(2);

await visit(base, async (page, context) => {
  await page.addInitScript(() => {
    const Real = WebSocket;
    window.sockets = [];
    window.WebSocket = class extends Real {
      constructor(address) {
        super(window.isCut ? "wss://127.0.0.1:9" : address);
        window.sockets.push(this);
      }
    };
  });
  await logIn(page, base, "olga", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await submit(page, 'set n to 1\nrepeat 2 times: (say "round {n}" then increase n by 1)\nsay "مرحبا \\<script>alert(1)\\</script>" then go to the statue then wait 10 minutes');
  await page.waitForSelector(".node[data-status=RUNNING]");
  await page.waitForFunction(() => document.querySelector(".running").textContent.includes("statue"));
  const log = await page.textContent(".log");
  assert.match(log, /says “مرحبا <script>/);
  assert.doesNotMatch(log, /Script code/, "what only prepares a command is in the log");
  await page.waitForSelector(".node:has-text('say \"round 2\"')");
  await accessible(page, "watch");

  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
  const began = Date.now();
  await page.click(".stop");
  await page.waitForSelector(".latch");
  assert.ok(Date.now() - began < 1500, "the stop came late");
  await page.waitForSelector(".pill.bad");
  await accessible(page, "stopped");
  await page.click(".release");
  await page.waitForSelector(".latch", { state: "detached" });
  await page.setViewportSize({ width: 1280, height: 800 });

  await submit(page, 'ask "Coffee?" then wait 10 minutes');
  await page.waitForSelector(".asks:has-text('Coffee?')");
  await accessible(page, "question");
  await page.fill(".question input", "Yes, please");
  await page.click(".question .primary");
  await page.waitForSelector(".question form", { state: "hidden" });
  await page.waitForSelector(".log li:has-text('hears “Yes, please”')");

  // Without the socket the request alone stops it, also by the key.
  await page.evaluate(() => {
    window.isCut = true;
    window.sockets.at(-1).close();
  });
  await page.waitForFunction(() => document.querySelector(".cut").textContent);
  await page.keyboard.press("Control+Shift+Period");
  await page.waitForFunction(() => document.querySelector(".alarm").textContent.includes("confirmed the stop"));
  await page.evaluate(() => (window.isCut = false));
  await page.waitForSelector(".latch");
  await page.click(".release");
  await page.waitForSelector(".latch", { state: "detached" });

  // With no connection at all people are told within a second.
  await context.setOffline(true);
  await page.evaluate(() => window.sockets.at(-1).close());
  const pressed = Date.now();
  await page.keyboard.press("Pause");
  await page.waitForSelector(".alarm.lost");
  assert.ok(Date.now() - pressed < 1000, "the warning came late");
  assert.match(await page.textContent(".alarm"), /STOP IT WHERE IT STANDS/);
});
