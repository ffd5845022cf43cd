// The button that is held while somebody speaks to the robot: with the pointer, and with the space bar.
import assert from "node:assert/strict";
import { accessible, logIn, visit } from "./browser.mjs";

const [base, password] = process.argv.slice(2);

await visit(base, async (page) => {
  const acts = [];
  page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => note(String(payload))));
  page.on("request", (request) => note(request.postData() ?? ""));
  const note = (text) => text.includes('"talk"') && acts.push(/hold|release/.exec(text)[0]);
  await logIn(page, base, "ann", password);
  await page.click(".robots a");
  const button = page.locator(".talk");
  await button.waitFor();
  await accessible(page, "talk");
  const held = () => page.waitForSelector('.talk[aria-pressed="true"]');
  const free = () => page.waitForSelector('.talk[aria-pressed="false"]');
  await button.hover();
  await page.mouse.down();
  await held();
  while (acts.length < 2) await page.waitForTimeout(100); // it is told again
  await page.mouse.up();
  await free();
  await button.focus();
  await page.keyboard.down("Space");
  await held();
  await page.keyboard.up("Space");
  await free();
  while (acts.filter((act) => act === "release").length < 2) await page.waitForTimeout(100);
  assert.deepEqual(acts.slice(0, 2), ["hold", "hold"]);
  assert.equal(await page.locator(".talking .problem").textContent(), "");
});
