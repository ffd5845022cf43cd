// A browser without a window, for the scenarios.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname } from "node:path";
import chromium from "@sparticuz/chromium";
import { chromium as playwright } from "playwright-core";

const SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
const axe = readFileSync(`${dirname(createRequire(import.meta.url).resolve("axe-core"))}/axe.min.js`, "utf8");
const REFUSED = /status of (400|401|409)|ERR_(INTERNET_DISCONNECTED|CONNECTION_REFUSED)|WebSocket/;

/** Calls `act` with a page; then there must have been no error but those `expected`, no violation of the policy, and no
 *  request elsewhere. There is no WebGL, unless it `draws`.
 */
export async function visit(base, act, options = {}, expected = REFUSED, draws = false) {
  chromium.setGraphicsMode = draws;
  const args = chromium.args.filter((each) => each !== "--single-process");
  const browser = await playwright.launch({ args: [...args, "--no-sandbox", ...(draws ? SOFTWARE : ["--disable-gpu"])], executablePath: await chromium.executablePath(), headless: true });
  try {
    const context = await browser.newContext({ ignoreHTTPSErrors: true, viewport: { width: 1280, height: 800 }, locale: "en-GB", ...options });
    context.setDefaultTimeout(15_000);
    const page = await context.newPage();
    const faults = [];
    page.on("pageerror", (error) => faults.push(error.message));
    page.on("console", (message) => message.type() === "error" && !expected.test(message.text()) && faults.push(message.text()));
    page.on("request", (request) => new URL(request.url()).hostname !== new URL(base).hostname && !request.url().startsWith("data:") && faults.push(request.url()));
    try {
      await act(page, context);
    } catch (error) {
      console.error(`${page.url()} said:\n${(await page.innerText("body", { timeout: 5000 }).catch(String)).slice(0, 3000)}`);
      throw error;
    }
    assert.deepEqual(faults, []);
  } finally {
    await browser.close();
  }
}

/** Logs in; the page then shows the robots. */
export async function logIn(page, base, name, password) {
  await page.goto(base);
  await page.fill("[name=name]", name);
  await page.fill("[name=password]", password);
  await page.click("form button");
  await page.waitForSelector(".robots a");
}

/** Fails where axe finds a serious fault of accessibility. */
export async function accessible(page, where) {
  const { violations } = await page.evaluate(`${axe}; axe.run(document, { resultTypes: ["violations"] })`);
  const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  const shown = serious.map(({ id, nodes }) => `${where}: ${id}: ${nodes.map(({ html, failureSummary }) => `${html.slice(0, 1500)} ${failureSummary}`).join("\n")}`);
  assert.deepEqual(shown, []);
}

/** Gives the robot of the page a mission. */
export async function submit(page, text) {
  await page.click("summary");
  await page.fill(".submit textarea", text);
  await page.click(".submit .primary");
  await page.waitForFunction(() => document.querySelector(".submit .said").textContent);
  await page.click("summary");
}

/** Nothing is wider than the window. */
export async function fits(page) {
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 0, "it's wider than the window");
}

/** Writes another text into the mission that is open. */
export async function replace(page, text) {
  await page.waitForSelector('.panes .text .cm-content[contenteditable="true"]:not([aria-readonly="true"])');
  await page.click(".panes .text .cm-content");
  await page.keyboard.press("Control+A");
  await page.keyboard.insertText(text);
}

/** Until the mission that is open has no mistakes, and its tree is that of the text. */
export async function understood(page) {
  await page.waitForSelector(".messages .fine");
  await page.waitForFunction(() => document.querySelector(".desk .tree").ariaBusy === "false");
}

/** The text of the mission that is open. */
export async function written(page) {
  return page.$$eval(".panes .text .cm-line", (lines) => lines.map((line) => line.textContent).join("\n"));
}

/** Until the text of the mission that is open is as wanted, or only a part of it. */
export async function untilWritten(page, wanted, { isPart = false } = {}) {
  await page.waitForFunction(([wanted, isPart]) => {
    const text = [...document.querySelectorAll(".panes .text .cm-line")].map((line) => line.textContent).join("\n");
    return isPart ? text.includes(wanted) : text === wanted;
  }, [wanted, isPart]);
}

/** Does what the menu "More" of the mission that is open offers. */
export async function more(page, words) {
  await page.getByRole("button", { name: "More …" }).click();
  await page.getByRole("menuitem", { name: words, exact: true }).click();
}

/** A file of the menu of downloads: its name and content. */
export async function downloaded(page, name) {
  await page.click("button[aria-haspopup=menu]:is(:has-text('Download'), :has-text('More'))");
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(`[role=menuitem]:has-text('(${name})')`)]);
  return [download.suggestedFilename(), readFileSync(await download.path())];
}
