// A picture in which something moved by three pixels isn't the golden one.
import assert from "node:assert/strict";
import { visit } from "./browser.mjs";
import { gallery } from "./golden.mjs";

const [base, , golden, found] = process.argv.slice(2);

await visit(base, async (page) => {
  await page.goto(base);
  await page.waitForSelector("[name=name]");
  const look = await gallery(page, golden, found);
  await look("log_in");
  if (!look.compares) return;
  await page.evaluate(() => {
    const style = new CSSStyleSheet();
    style.replaceSync(".login button { translate: 3px; }");
    document.adoptedStyleSheets = [style];
  });
  await assert.rejects(look("log_in"), /log_in differs in \d+ pixels/);
});
