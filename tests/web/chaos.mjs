// What a page says while things go wrong: prints samples as JSON, a line each, until standard input ends.
import { createInterface } from "node:readline";
import { logIn, visit } from "./browser.mjs";

const [base, password] = process.argv.slice(2);

await visit(base, async (page) => {
  await logIn(page, base, "ann", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await page.evaluate(() => (window.samples = []) && setInterval(() => {
    const text = (where) => document.querySelector(where)?.textContent ?? "";
    window.samples.push({ t: Date.now() / 1000, pill: text(".now .pill"), gone: text(".gone"), stale: !!document.querySelector(".place.stale"), cut: text(".cut"), stop: text(".stops") });
  }, 100));
  console.log(JSON.stringify({ ready: true }));
  for await (const line of createInterface({ input: process.stdin })) {
    if (line === "stop") await page.click("button.stop");
    console.log(JSON.stringify(await page.evaluate(() => window.samples.splice(0))));
  }
}, {}, /./);
