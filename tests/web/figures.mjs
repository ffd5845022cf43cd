// How fast large trees are, with messages as a server sends them. Prints figures as JSON.
import { logIn, visit } from "./browser.mjs";

const [base, password, seconds = "3"] = process.argv.slice(2);
const figures = {};

/** A tree of so many nodes, ten below each. */
function nodes(count) {
  const found = [["/", "Sequence", "Sequence", {}]];
  const add = (path, left) => {
    if (left <= 10) return Array.from({ length: left }, (_, i) => found.push([`${path}/${i}`, "Say", `say "number ${found.length}"`, { text: `number ${found.length}` }]));
    const each = Math.floor((left - 10) / 10);
    for (let i = 0; i < 10; i++) {
      found.push([`${path}/${i}`, "Sequence", "Sequence", {}]);
      add(`${path}/${i}`, i ? each : left - 10 - 9 * each);
    }
  };
  add("", count - 1);
  return found;
}

const frames = (page, seconds) => page.evaluate((seconds) => new Promise((done) => {
  const began = performance.now();
  const gaps = [];
  let last = began;
  requestAnimationFrame(function next(now) {
    gaps.push(now - last);
    last = now;
    if (now - began < seconds * 1000) requestAnimationFrame(next);
    else done({ frames: Math.round(gaps.length / seconds), worst: Math.round(Math.max(...gaps.slice(2))) });
  });
}), seconds);

await visit(base, async (page) => {
  let socket;
  await page.routeWebSocket(/api\/ws/, (routed) => {
    socket = routed;
    routed.send(JSON.stringify({ type: "auth_ok" }));
    routed.onMessage((text) => JSON.parse(text).type === "subscribe" && routed.send(JSON.stringify({ robot: "robot", type: "up", change: 1 })));
  });
  const tell = (message) => socket.send(JSON.stringify({ robot: "robot", ...message }));
  await logIn(page, base, "olga", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  for (const count of [500, 2000, 10_000]) {
    const run = `run${count}`;
    const began = Date.now();
    tell({ type: "run", run, task: count, nodes: nodes(count) });
    tell({ type: "statuses", run, t: 0, changes: [[0, "RUNNING"]] });
    await page.waitForSelector(".node[data-status=RUNNING]");
    const opened = Date.now() - began;
    if (count < 10_000) await page.click("button[aria-label='Unfold all']");
    let turn = 0;
    const ticking = setInterval(() => {
      turn += 1;
      const changes = Array.from({ length: Math.min(count, 2000) }, (_, index) => [index, ["RUNNING", "SUCCESS", "FAILURE"][(turn + index) % 3]]);
      tell({ type: "statuses", run, t: turn, changes });
    }, 50);
    const still = await frames(page, Number(seconds));
    const scrolling = page.evaluate((seconds) => new Promise((done) => {
      const tree = document.querySelector(".scroll");
      const began = performance.now();
      requestAnimationFrame(function next(now) {
        tree.scrollTop = (now - began) * 2;
        if (now - began < seconds * 1000) requestAnimationFrame(next);
        else done();
      });
    }), Number(seconds));
    const scrolled = await frames(page, Number(seconds));
    await scrolling;
    clearInterval(ticking);
    figures[count] = { opened, still, scrolled, drawn: await page.evaluate(() => document.querySelectorAll(".node").length) };
  }
});
console.log(JSON.stringify(figures));
