// The link is cut in the middle of writing: the page says so, and the draft is offered again.
import { end, faults, launch, logIn, open, picture, until, write, written } from "./browser.mjs";

const [base, password] = process.argv.slice(2);
const browser = await launch();
const page = await open(browser, base, { expected: /409|ERR_INTERNET_DISCONNECTED|ERR_NETWORK/ });
await logIn(page, base, "ed", password, "#/robots/robot");
await page.goto(`${base}/#/write/cut`);
await write(page, 'say "before".');
await page.waitForSelector(".messages .fine");
await page.context().setOffline(true);
await write(page, 'say "offline".');
await page.click('button:text-is("Save")');
await until(page, () => [...document.querySelectorAll(".problem")].some((each) => each.textContent.includes("kept in this browser")));
await picture(page, "cut");
await page.context().setOffline(false);
await page.reload();
await page.click(".offered .primary");
if (!(await written(page)).includes("offline")) faults.push("the draft is lost");
await picture(page, "draft");
await page.click('button:text-is("Save")');
await until(page, () => document.querySelector(".desk .state").textContent === "Saved");
await end(browser);
