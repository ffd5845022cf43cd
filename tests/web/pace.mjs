// From a status that changes in the robot to its picture, and from a key to what is said of 2,000 lines. Prints JSON.
import { readFileSync } from "node:fs";
import { logIn, replace, submit, visit } from "./browser.mjs";

const [base, password, running, long, seconds = "20", keys = "30"] = process.argv.slice(2);
const figures = {};

/** The middle and the 95th of a hundred, in milliseconds. */
function spread(times) {
  const sorted = [...times].sort((one, other) => one - other);
  const at = (part) => Math.round(sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * part))]);
  return { p50: at(0.5), p95: at(0.95), worst: at(1), count: times.length };
}

await visit(base, async (page) => {
  await page.addInitScript(() => {
    window.lags = [];
    window.painted = (from) => requestAnimationFrame(() => setTimeout(() => lags.push(performance.timeOrigin + performance.now() - from)));
    window.WebSocket = class extends WebSocket {
      set onmessage(take) {
        super.onmessage = (event) => {
          take(event);
          const said = /"type": ?"statuses".*?"t": ?([\d.]+)/.exec(event.data);
          if (said) window.painted(Number(said[1]) * 1000);
        };
      }
    };
  });
  await logIn(page, base, "ed", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await submit(page, readFileSync(running, "utf8"));
  await page.waitForSelector(".node[data-status=RUNNING]");
  await page.click("button[aria-label='Unfold all']");
  await page.waitForTimeout(3000);
  figures.painted = spread(await page.evaluate((seconds) => new Promise((done) => {
    lags.length = 0;
    setTimeout(() => done(lags), seconds * 1000);
  }), Number(seconds)));
  await page.click('button:text-is("Cancel")');
  await page.waitForSelector('button:text-is("Cancel")', { state: "hidden" });

  await page.evaluate(() => (location.hash = "#/write/long"));
  await replace(page, readFileSync(long, "utf8"));
  await page.waitForSelector(".messages li:not(.fine)", { timeout: 60_000 });
  await page.waitForTimeout(2000);
  await page.evaluate(() => {
    window.pressed = 0;
    document.addEventListener("keydown", () => (window.pressed = performance.timeOrigin + performance.now()), true);
    new MutationObserver(() => window.painted(window.pressed)).observe(document.querySelector(".messages"), { childList: true });
    lags.length = 0;
  });
  await page.keyboard.press("Control+Home");
  for (let key = 1; key <= Number(keys); key++) {
    await page.keyboard.press(key % 2 ? "#" : "Backspace");
    await page.waitForFunction((key) => lags.length === key, key);
    await page.waitForTimeout(200); // as somebody types
  }
  figures.keys = spread(await page.evaluate(() => lags));
});
console.log(JSON.stringify(figures));
