// A picture of the page of the guide, while it welcomes people: `python docs/make_pictures.py --page`.
import { logIn, visit } from "./browser.mjs";

const [base, password, picture] = process.argv.slice(2);
const WAVED = 1500; // milliseconds after it has begun to speak

await visit(base, async (page) => {
  await logIn(page, base, "olga", password);
  await page.click(".robots a");
  await page.waitForSelector(".body canvas[aria-label]");
  await page.click(".choices button:text-is('tour')");
  await page.waitForSelector(".bubble:has-text('Welcome')", { timeout: 60_000 });
  await page.waitForTimeout(WAVED);
  await page.screenshot({ path: picture });
}, { viewport: { width: 1200, height: 760 } }, undefined, true);
