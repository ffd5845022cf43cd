// Somebody watches a run of `btc run --watch`, and then its recording, without a log-in.
import assert from "node:assert/strict";
import { accessible, fits, visit } from "./browser.mjs";

const [address, kind, folder] = process.argv.slice(2);
const base = new URL(address).origin;
const picture = (page, name) => folder && page.screenshot({ path: `${folder}/${name}.png` });

await visit(base, async (page) => {
  await page.goto(address);
  const screen = kind === "run" ? ".watch" : ".film";
  await page.waitForSelector(`${screen} canvas.map`);
  assert.equal(new URL(page.url()).hash.includes("token"), false, "the token is still in the address");
  assert.match(await page.textContent(".film-text"), /say "Good morning!"/);
  if (kind === "run") {
    await page.waitForSelector(".node[data-status=RUNNING]");
    await page.waitForSelector(".film-text mark:has-text('kitchen')");
    await page.waitForFunction(() => document.querySelector(".speech").textContent.includes("Good morning!"));
    await picture(page, "watch_run");
    await page.waitForSelector(".log li:has-text('succeeded')");
    assert.equal(await page.locator(".controls button, .submit, .question form:visible").count(), 0, "a viewer gets buttons");
    assert.ok(await page.isVisible(".stop"));
  } else {
    await page.click(".timeline .primary");
    await page.waitForSelector(".node[data-status=RUNNING]");
    await page.waitForFunction(() => document.querySelector(".speech").textContent.includes("Good morning!"));
    assert.equal(await page.isVisible(".stop"), false);
    await picture(page, "watch_recording");
  }
  assert.equal(await page.isVisible("nav"), false, "a page of one screen has tabs");
  await accessible(page, kind);
  await page.reload();
  await page.waitForSelector(`${screen} canvas.map`);
  await page.waitForSelector(".node[data-status]");
  await picture(page, `watch_${kind}_end`);
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
});
