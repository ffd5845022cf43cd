// Nodes of a tree are dragged by mouse and by finger; Escape, other kinds of nodes and a finger that scrolls change nothing.
// Two values are changed at once, and nothing before the tree is that of the text.
import assert from "node:assert/strict";
import { logIn, more, replace, understood, untilWritten, visit, written } from "./browser.mjs";

const [base, password] = process.argv.slice(2);
const TEXT = "wave  # to all\nrepeat 2 times:\n  nod\n  look around\nif the battery is low:\n  dock";

await visit(base, async (page, context) => {
  page.on("dialog", (dialog) => void dialog.accept()); // leaving with a draft asks first
  const untilText = (wanted) => untilWritten(page, wanted);
  const still = async (wanted) => {
    await page.waitForTimeout(300);
    assert.equal(await written(page), wanted);
  };
  const place = async (words, down = 0.5, across = 0.5) => {
    const { x, y, width, height } = await page.locator(".node", { hasText: words }).first().boundingBox();
    return [x + width * across, y + height * down];
  };
  const marked = () => page.getAttribute(".drop", "d");
  const fine = async () => {
    await understood(page);
    await page.waitForTimeout(100);
  };
  /** Without letting go. */
  const drag = async (from, to) => {
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 4 });
  };

  await logIn(page, base, "ed", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  await page.evaluate(() => (location.hash = "#/write/dragged"));
  await replace(page, TEXT);
  await fine();
  await page.click("button[aria-label='Fit into the window']");

  // with the mouse, into another chain and out of it; the comment comes with its line
  await drag(await place("wave"), await place("nod", 0.9));
  assert.ok(await marked());
  await page.waitForSelector(".node.lifted");
  await page.mouse.up();
  const into = "repeat 2 times:\n  nod\n  wave  # to all\n  look around\nif the battery is low:\n  dock";
  await untilText(into);
  assert.equal(await marked(), "");
  await fine();
  await drag(await place("nod"), await place("repeat 2 times", 0.1));
  await page.mouse.up();
  await untilText("nod\nrepeat 2 times:\n  wave  # to all\n  look around\nif the battery is low:\n  dock");
  await more(page, "Undo");
  await untilText(into);
  await fine();

  // Escape, itself, what is in it, and a place for conditions
  await drag(await place("wave"), await place("dock", 0.9));
  assert.ok(await marked());
  await page.keyboard.press("Escape");
  assert.equal(await marked(), "");
  await page.mouse.up();
  await drag(await place("repeat 2 times"), await place("look around"));
  assert.equal(await marked(), "");
  await page.mouse.up();
  await drag(await place("nod"), await place("battery"));
  assert.equal(await marked(), "");
  await page.mouse.up();
  await drag(await place("then"), await place("dock", 0.9)); // the root has no other place
  assert.equal(await page.$(".node.lifted"), null);
  await page.mouse.up();
  await still(into);

  // top-down, left and right count
  await page.click("button[aria-label='Turn the tree']");
  await page.click("button[aria-label='Fit into the window']");
  await drag(await place("look around"), await place("nod", 0.5, 0.1));
  await page.mouse.up();
  const turned = "repeat 2 times:\n  look around\n  nod\n  wave  # to all\nif the battery is low:\n  dock";
  await untilText(turned);
  await fine();

  // with a finger: a short touch scrolls, a long one lifts; where it doesn't move, the menu opens
  const touches = await context.newCDPSession(page);
  const touch = (type, ...at) => touches.send("Input.dispatchTouchEvent", { type, touchPoints: at.length ? [{ x: at[0], y: at[1] }] : [] });
  const [from, to] = [await place("wave"), await place("look around", 0.5, 0.1)];
  await touch("touchStart", ...from);
  await touch("touchMove", from[0] - 20, from[1]);
  await touch("touchMove", ...to);
  assert.equal(await marked(), "");
  await touch("touchEnd");
  await still(turned);
  const [lifted, left] = [await place("wave"), await place("look around", 0.5, 0.1)];
  await touch("touchStart", ...lifted);
  await page.waitForSelector(".node.lifted");
  await touch("touchMove", lifted[0] - 10, lifted[1]);
  await touch("touchMove", ...left);
  assert.ok(await marked());
  await touch("touchEnd");
  await untilText("repeat 2 times:\n  wave  # to all\n  look around\n  nod\nif the battery is low:\n  dock");
  await fine();
  const pressed = await place("nod");
  await touch("touchStart", ...pressed);
  await page.waitForSelector(".node.lifted");
  await touch("touchEnd");
  await page.waitForSelector("[role=menuitem]");
  await page.keyboard.press("Escape");

  // two values of a node, or none, and one step of undo
  const moving = "move forward 1 m at 0.2 m/s";
  const button = (words) => page.getByRole("button", { name: words, exact: true });
  const values = async (distance, speed) => {
    await page.locator(".node", { hasText: "move forward" }).click({ button: "right" });
    await page.getByRole("menuitem", { name: "Change values" }).click();
    await page.fill("dialog [name=distance]", distance);
    await page.fill("dialog [name=speed]", speed);
    await button("OK").click();
  };
  await replace(page, moving);
  await fine();
  await values("2 m", "0.3 m/s");
  await untilText("move forward 2 m at 0.3 m/s");
  await more(page, "Undo");
  await untilText(moving);
  await fine();
  await values("2 m", "tea");
  await page.waitForFunction(() => document.querySelector("dialog .problem").textContent);
  await still(moving);
  await page.keyboard.press("Escape");

  // while the server reads what was written, nothing is asked about nodes of the older text
  let answer;
  const asked = new Promise((done) => (answer = done));
  await page.route("**/api/document", (route) => asked.then(() => route.continue()));
  await replace(page, "wave");
  await page.locator(".node", { hasText: "move forward" }).click({ button: "right" });
  await page.getByRole("menuitem", { name: "Add after it" }).click();
  await page.waitForFunction(() => document.querySelector(".desk").textContent.includes("The text has changed meanwhile"));
  await still("wave");
  answer();
  await fine();
}, { hasTouch: true });
