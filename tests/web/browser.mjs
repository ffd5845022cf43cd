// A browser for the scenarios, which notes whatever a page must not do.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

import chromium from "@sparticuz/chromium";
import { chromium as launcher } from "playwright-core";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf-8");
const PICTURES = process.env.BTLANG_SCREENSHOTS;
export const faults = [];

/** A browser without a window. */
export async function launch() {
  return launcher.launch({ args: [...chromium.args, "--no-sandbox"], executablePath: await chromium.executablePath(), headless: true });
}

/** A page of somebody who isn't logged in. `expected` are console errors that the scenario provokes. */
export async function open(browser, base, { expected = /^$/, ...options } = {}) {
  const context = await browser.newContext({ ignoreHTTPSErrors: true, viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(15_000);
  page.on("console", (message) => message.type() === "error" && !expected.test(message.text()) && faults.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => faults.push(`error: ${error.stack}`));
  page.on("dialog", (dialog) => {
    if (dialog.type() !== "beforeunload") faults.push(`dialog: ${dialog.message()}`);
    void dialog.accept();
  });
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url()) && new URL(request.url()).host !== new URL(base).host) faults.push(`elsewhere: ${request.url()}`);
  });
  await page.addInitScript(() => addEventListener("securitypolicyviolation", (event) => console.error(`policy: ${event.violatedDirective} ${event.blockedURI} ${event.sourceFile}:${event.lineNumber}`)));
  return page;
}

export async function logIn(page, base, name, password, hash = "") {
  await page.goto(`${base}/login${hash}`);
  await page.fill("[name=name]", name);
  await page.fill("[name=password]", password);
  await page.click("form button");
  await page.waitForSelector("header .stop");
}

/** Replaces the text of the mission that is open. */
export async function write(page, text) {
  await page.waitForSelector('.cm-content[contenteditable="true"]:not([aria-readonly="true"])');
  await page.click(".cm-content");
  await page.keyboard.press("Control+A");
  await page.keyboard.insertText(text);
}

/** The text of the mission that is open. */
export async function written(page) {
  return page.$$eval(".text .cm-line", (lines) => lines.map((line) => line.textContent).join("\n"));
}

/** Waits until a function of the page's own gives something true. */
export const until = (page, check, argument) => page.waitForFunction(check, argument);

/** Notes serious faults of accessibility. The words of a node may be shortened with "…", its name has all of them. */
export async function accessible(page, where) {
  const found = await page.evaluate(`(() => { ${AXE}; return axe.run(document, { resultTypes: ["violations"], rules: { "label-content-name-mismatch": { enabled: false } } }); })()`);
  for (const { id, impact, nodes } of found.violations) {
    if (impact === "serious" || impact === "critical") faults.push(`axe, ${where}: ${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(" | ")}`);
  }
}

export async function picture(page, name) {
  if (PICTURES) await page.screenshot({ path: `${PICTURES}/${name}.png` });
}

/** Ends the scenario: what was noted, one a line, is what is printed. */
export async function end(browser) {
  await browser.close();
  console.log(faults.join("\n"));
}
