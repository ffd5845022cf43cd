// A humanoid in 3D: it moves, speaks, and gives a tour after one click. Without WebGL the page says so. Its URDF is read,
// and names on its map are beside one another.
import assert from "node:assert/strict";
import pixelmatch from "pixelmatch";
import { PNG } from "pngjs";
import { accessible, fits, logIn, submit, visit } from "./browser.mjs";

const [base, password, parts] = process.argv.slice(2);
const MOVED = 400; // pixels
const LONG = 60_000; // milliseconds for what a busy computer draws
const CANVAS = ".body canvas[aria-label]";

await visit(base, async (page) => {
  await reads(page);
  await names(page);
  await logIn(page, base, "olga", password);
  await page.click(".robots a");
  const canvas = await page.waitForSelector(CANVAS);
  await page.waitForSelector(".choices button");
  const look = async () => PNG.sync.read(await canvas.screenshot());
  const until = async (act, what) => {
    const before = await look();
    await act();
    for (const end = Date.now() + LONG; ; ) {
      const now = await look();
      if (pixelmatch(before.data, now.data, null, now.width, now.height, { threshold: 0.2 }) > MOVED) return;
      assert.ok(Date.now() < end, what);
    }
  };
  for (const end = Date.now() + LONG; new Set((await look()).data).size < 20; ) assert.ok(Date.now() < end, "nothing is drawn");
  await until(() => submit(page, "raise both arms"), "it shows no gesture");
  await until(() => canvas.press("ArrowLeft"), "the keys don't turn it");

  await page.click(".choices button:text-is('tour')");
  await page.waitForFunction(() => document.querySelector(".says mark")?.textContent && document.querySelector(".bubble:not([hidden]) mark"));
  assert.match(await canvas.getAttribute("aria-label"), /in 3D: .*say/);
  await page.waitForSelector(".now h1:has-text('tour')");
  await page.click(".controls button:text-is('Pause')"); // it goes on for as long as a busy computer needs
  await page.waitForSelector(".controls button:text-is('Go on')");
  await accessible(page, "guide");
  await page.fill(".watch input[type=search]", "approach");
  await page.keyboard.press("Enter");
  const found = await page.evaluate(() => document.getElementById(document.querySelector("[role=tree]").getAttribute("aria-activedescendant")).getAttribute("aria-label"));
  assert.match(found, /approach vase/, "the tree doesn't say what is approached");
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);

  assert.ok(!(await canvas.evaluate((each) => each.getContext("webgl2").isContextLost())));
  await page.click(".tabs a[href$='/tasks']");
  await page.waitForSelector("ul.tasks .what:has-text('short_tour')");
  assert.ok(await canvas.evaluate((each) => each.getContext("webgl2").isContextLost()), "it keeps the graphics card");
  await offersNothing(page);
}, {}, undefined, true);

await visit(base, async (page) => {
  await logIn(page, base, "vic", password);
  await page.click(".robots a");
  await page.waitForSelector(".body .empty:has-text('no WebGL')");
  await page.waitForSelector("canvas.map");
});

/** Back at a robot that gives a tour: the library is asked for once, and nothing of it is offered, however late it comes. */
async function offersNothing(page) {
  let asked = 0;
  await page.route("**/api/missions?*", async (route) => {
    asked++;
    await page.waitForSelector(".now h1:has-text('tour')").catch(() => {}); // whoever waits for the page tells of it
    await route.continue().catch(() => {});
  });
  await page.evaluate(() => {
    const look = () => (globalThis.offered ||= Boolean(document.querySelector(".starts:not([hidden])")));
    new MutationObserver(look).observe(document, { subtree: true, childList: true, attributes: true });
  });
  await page.goBack();
  await page.waitForSelector(".submit option[value='tour']", { state: "attached" });
  assert.ok(!(await page.evaluate(() => globalThis.offered)), "it offers missions while one runs");
  assert.equal(asked, 1);
}

/** What the page makes of URDF, and of what is none. */
async function reads(page) {
  await page.addScriptTag({ path: `${parts}/urdf.js` });
  const read = (text) => page.evaluate((text) => {
    try {
      const found = globalThis.urdf.readUrdf(text);
      return { ...found, links: Object.fromEntries(found.links), moving: globalThis.urdf.moving(found).map(({ name }) => name) };
    } catch (error) {
      return error.message;
    }
  }, text);
  const joint = (name, parent, child, type = "revolute") => `<joint name="${name}" type="${type}"><parent link="${parent}"/><child link="${child}"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/></joint>`;
  const visual = '<visual><origin xyz="1 2 3" rpy="0 1.5 0"/><geometry><cylinder radius="0.1" length="0.4"/></geometry></visual><visual><geometry><mesh filename="arm.stl"/></geometry></visual>';
  const body = (...parts) => `<robot name="r"><link name="a">${visual}</link><link name="b"/><link name="c"/>${parts.join("")}</robot>`;

  const found = await read(body(joint("turn", "a", "b"), joint("bolt", "b", "c", "fixed")));
  assert.deepEqual(found.links["a"], [{ kind: "cylinder", size: [0.1, 0.4], at: [1, 2, 3], turned: [0, 1.5, 0] }]);
  assert.deepEqual([found.root, found.moving], ["a", ["turn"]]);
  assert.deepEqual(found.joints[0], { name: "turn", kind: "turns", parent: "a", child: "b", at: [0, 0, 1], turned: [0, 0, 0], axis: [0, 1, 0] });
  assert.match(await read("no XML <"), /no element 'robot'/);
  assert.match(await read(body(joint("turn", "a", "nowhere"))), /on a link that isn't there/);
  assert.match(await read(body(joint("turn", "a", "b"))), /no tree/);
  assert.match(await read(body(joint("one", "b", "c"), joint("two", "c", "b"))), /no tree/);
  assert.match(await read(body(joint("one", "a", "c"), joint("two", "b", "c"))), /on two joints/);
  assert.match(await read(body().replace("0.1", "NaN")), /needs 1 numbers/);
}

/** Names of things at one place, at an edge and beside the robot are in the picture, and not over one another. Those that
 *  aren't beside what they name have a line to it.
 */
async function names(page) {
  await page.addScriptTag({ path: `${parts}/labels.js` });
  const [boxes, lines] = await page.evaluate(() => {
    const canvas = document.body.appendChild(Object.assign(document.createElement("canvas"), { width: 300, height: 150 }));
    const pen = canvas.getContext("2d");
    const found = [["robot", 140, 65, 160, 85]];
    const lines = [];
    pen.moveTo = (x, y) => lines.push([x, y]);
    pen.lineTo = (x, y) => lines.at(-1).push(x, y);
    pen.fillText = (text, x, y) => found.push([text, x, y - 6, x + pen.measureText(text).width, y + 6]);
    const labels = new globalThis.labels.Labels();
    labels.keepFree([150, 75], 10);
    for (const name of ["reception", "Alice", "statue", "entrance", "cup", "map"]) labels.add(name, [150, 75], "black", 5);
    for (const [name, at] of [["corner", [0, 0]], ["other corner", [299, 149]]]) labels.add(name, at, "black", 5);
    labels.write(pen, "white");
    canvas.remove();
    return [found, lines];
  });
  assert.equal(boxes.length, 9);
  const far = boxes.filter(([name, left, top, right, bottom]) => !/robot|corner/.test(name) && Math.hypot(Math.max(left - 150, 0, 150 - right), Math.max(top - 75, 0, 75 - bottom)) > 27);
  assert.ok(far.length > 0 && far.length < 6, String(far));
  assert.deepEqual(lines.map(([x, y]) => [x, y]), far.map(() => [150, 75]));
  for (const [, , x, y] of lines) assert.ok(far.some(([, left, top, right, bottom]) => x >= left && x <= right && y >= top - 1 && y <= bottom + 1), "a line leads to no name");
  const crowd = await page.evaluate(() => {
    const canvas = document.body.appendChild(Object.assign(document.createElement("canvas"), { width: 240, height: 120 }));
    const pen = canvas.getContext("2d");
    const found = [];
    pen.fillText = (text, x, y) => found.push([text, x, y - 7, x + pen.measureText(text).width, y + 7]);
    const labels = new globalThis.labels.Labels();
    for (let number = 0; number < 60; number++) labels.add(`place ${number}`, [(number * 37) % 240, (number * 53) % 120], "black", 5);
    labels.write(pen, "white");
    canvas.remove();
    return found;
  });
  assert.ok(crowd.length > 10 && crowd.length < 60, "in a crowd the first ones are written");
  for (const [name, left, top, right, bottom] of crowd) {
    for (const [other, ...box] of crowd) assert.ok(other === name || box[0] >= right || box[2] <= left || box[1] >= bottom || box[3] <= top, `${name} is over ${other}`);
  }
  for (const [name, left, top, right, bottom] of boxes) {
    assert.ok(left >= 0 && top >= 0 && right <= 300 && bottom <= 150, `${name} is outside`);
    for (const [other, ...box] of boxes) {
      const apart = box[0] >= right || box[2] <= left || box[1] >= bottom || box[3] <= top;
      assert.ok(other === name || apart, `${name} is over ${other}`);
    }
  }
}
