// Eight hours of a robot's news, as fast as the page takes them. Prints what its memory was behind each as JSON.
import { logIn, visit } from "./browser.mjs";

const [base, password, hours = "8"] = process.argv.slice(2);
const NODES = 500;

await visit(base, async (page, context) => {
  await page.addInitScript(() => {
    window.WebSocket = class extends WebSocket {
      set onmessage(take) {
        window.tell = (message) => take({ data: JSON.stringify({ robot: "robot", ...message }) });
        this.addEventListener("open", () => { // what the server says is not heard
          take({ data: '{"type": "auth_ok"}' });
          window.tell({ type: "up", change: 1 });
        });
      }
    };
  });
  await logIn(page, base, "olga", password);
  await page.click(".robots a");
  await page.waitForSelector(".watch");
  const devtools = await context.newCDPSession(page);
  const memory = [];
  for (let half = 0; half <= 2 * Number(hours); half++) {
    if (half) await page.evaluate(hear, { half, nodes: NODES });
    await devtools.send("HeapProfiler.collectGarbage");
    const { usedSize } = await devtools.send("Runtime.getHeapUsage");
    const { nodes } = await devtools.send("Memory.getDOMCounters");
    memory.push({ hours: half / 2, megabytes: Math.round(usedSize / 1e5) / 10, elements: nodes });
  }
  console.log(JSON.stringify(memory));
});

/** Half an hour at 20 Hz: three missions that drive, scan and speak. */
async function hear({ half, nodes }) {
  const STATUSES = ["RUNNING", "SUCCESS", "FAILURE", "IDLE"];
  const tree = [["/", "Sequence", "Sequence", {}], ...Array.from({ length: nodes - 1 }, (_, index) => [`/${index}`, "Say", `say "number ${index}"`, { text: `number ${index}` }])];
  for (let tick = 0; tick < 30 * 60 * 20; tick++) {
    const task = half * 10 + Math.floor(tick / 12_000);
    const wall = 1_800_000_000 + half * 1800 + tick / 20;
    if (tick % 12_000 === 0) {
      tell({ type: "change", number: task * 2, task, state: "underway", time: wall });
      tell({ type: "run", run: `run${task}`, task, outline: "", nodes: tree });
    }
    const changes = Array.from({ length: 20 }, (_, index) => [(tick * 20 + index) % nodes, STATUSES[(tick + index) % 4]]);
    tell({ type: "statuses", run: `run${task}`, t: wall, changes });
    tell({ type: "robot", paused: false, pose: [Math.sin(tick / 300) * 5, Math.cos(tick / 300) * 5, tick / 300], battery: 100 - (tick % 36_000) / 400, left: "", right: "" });
    if (tick % 10 === 0) tell({ type: "scan", pose: [0, 0, 0], ranges: Array.from({ length: 72 }, (_, index) => 1 + ((tick + index) % 40) / 10) });
    if (tick % 20 === 0) tell({ type: "event", task, event: { event: "say", wall, t: tick / 20, text: `hello ${tick}`, run: `run${task}` } });
    if (tick % 200 === 0) await new Promise((done) => requestAnimationFrame(done));
  }
}
