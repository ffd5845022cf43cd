// A first user: writes a mission with a mistake, mends it, changes it by the tree, runs it, watches, stops, releases.
import { accessible, end, faults, launch, logIn, open, picture, until, write, written } from "./browser.mjs";

const [base, password] = process.argv.slice(2);
const HOSTILE = "<script>alert(1)</script><img src=x onerror=alert(2)>\u202e\u0007\u001b[2J";
const browser = await launch();
const page = await open(browser, base, { expected: /409/ }); // a browser notes that there is no such mission yet
await page.goto(`${base}/login#/robots/robot`);
await page.waitForSelector("[name=name]");
await accessible(page, "log-in");
await picture(page, "login");
await logIn(page, base, "ed", password, "#/robots/robot");

await page.goto(`${base}/#/write/tea`);
await write(page, "Go to the fountian.\nRepeat 3 times: say \"Tea?\" then wait 5 seconds.\nGo to the cafe.\n");
await page.waitForSelector(".messages .error");
await picture(page, "mistake");
await page.click(".messages .error button");
await page.keyboard.press("Control+.");
await page.waitForSelector(".messages .fine");
await page.waitForSelector(".tree:not(.stale) .node");
await accessible(page, "write");
await picture(page, "tree");

await command("Repeat", "Change values");
await page.fill("dialog input", "4");
await page.click("dialog .primary");
await until(page, () => document.querySelector(".cm-content").textContent.includes("4 times"));
await settled();
await command("Say", "Wrap");
await page.selectOption("dialog [name=form]", "retry");
await page.fill("dialog [name=count]", "2");
await picture(page, "wrap");
await page.click("dialog .primary");
await until(page, () => /up to 3 times|3 times/.test(document.querySelector(".cm-content").textContent.replace("4 times", "")));
await settled();
await picture(page, "wrapped");
await page.keyboard.press("Escape");
await page.click('button:text-is("Save")');
await until(page, () => document.querySelector(".state").textContent === "Saved");
const text = await written(page);
if (!text.includes("fountain") || !text.includes("4 times")) faults.push(`text: ${text}`);

await page.click("text=Run on the robot");
await page.waitForSelector('.watch .node[data-status="RUNNING"]');
await accessible(page, "watch");
await picture(page, "watch");
await page.click("header .stop");
await page.waitForSelector(".latch .release");
await picture(page, "stopped");
await page.click(".latch .release");
await page.waitForSelector(".latch", { state: "detached" });

await page.goto(`${base}/#/write/${encodeURIComponent(HOSTILE)}`);
await write(page, `say "${HOSTILE}"`);
await page.waitForSelector(".tree:not(.stale) .node");
await page.waitForSelector(".messages li");
if (await page.$("main script, main img[src]")) faults.push("markup of a mission is in the document");
await picture(page, "hostile");

await page.evaluate(() => (document.documentElement.dataset.theme = "dark"));
await page.setViewportSize({ width: 360, height: 740 });
await picture(page, "narrow");
if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)) faults.push("wider than 360 pixels");
await end(browser);

/** A command of the menu of a node whose name begins so. */
async function command(node, name) {
  await page.click(`.tree .node[aria-label^="${node}"]`, { button: "right" });
  await page.click(`.menu button:has-text("${name}")`);
  await page.waitForSelector("dialog[open]");
}

/** Until the tree is that of the text. */
async function settled() {
  await page.waitForSelector("dialog", { state: "detached" });
  await page.waitForSelector(".messages .fine");
  await page.waitForTimeout(400);
}
