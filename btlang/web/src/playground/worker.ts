// The worker of the playground: Python with btlang, in one thread. It answers the page, and steps the run between answers.
import type { loadPyodide, PyodideInterface } from "pyodide";

/** What is done for the page: a method of Playground (btlang/playground/playground.py), or the speed of the run. */
export interface Request {
  id: number;
  does: "house" | "ask" | "begin" | "hear" | "stop" | "speed";
  given: unknown[];
}

/** What the page hears: how far the start is, answers, news of the run that nobody asked for, and that Python is at its end. */
export type Reply = { stage: "python" | "words" | "ready" } | { id: number; answer: any } | { run: any } | { broken: true };

interface Playground {
  [method: string]: (...given: unknown[]) => string;
}

const HOME = "/home/pyodide";
const PATH = "/lib/btlang";
const PERIOD = 0.05; // seconds of the mission between two ticks
const PATIENCE = 0.03; // seconds for which ticks may keep answers waiting
const BEHIND = 5; // periods that are caught up with: a slow computer makes the mission slower, not jerky
const IDLE = 20; // milliseconds
const WARM = 500; // milliseconds between two of these, which fill what explains mistakes: else the first ones take half a second
const MISTAKES = ["go to the kichen", "w", "wave a"];

const reply = (data: Reply): void => (self as unknown as Worker).postMessage(data);

let speed = 1; // seconds of the mission in a second
let turn = 0; // of the run under way
let driving = 0; // runs that are stepped

async function start(): Promise<Playground> {
  const files = new URL("./", self.location.href);
  const archive = fetch(new URL("btlang.zip", files)).then((answer) => (answer.ok ? answer.arrayBuffer() : Promise.reject(new Error(`btlang.zip: ${answer.status}`))));
  archive.catch(() => undefined); // it's awaited below, and may fail before
  const { loadPyodide: load } = (await import(new URL("pyodide.mjs", files).href)) as { loadPyodide: typeof loadPyodide };
  const lock = await (await fetch(new URL("lock.json", files))).text();
  const python: PyodideInterface = await load({ indexURL: files.href, lockFileContents: lock, env: { HOME }, packages: [] });
  reply({ stage: "words" });
  python.unpackArchive(await archive, "zip", { extractDir: "/" });
  return python.runPython(`
import sys
sys.path.append("${PATH}")
from btlang.playground import prepare
prepare("${HOME}")
from btlang.playground.playground import Playground
playground = Playground()
playground.ask("document", "wave")
playground
`) as Playground;
}

/** Reads mistakes while no mission runs. */
function warmUp(playground: Playground, [first, ...others]: string[]): void {
  if (!first) return;
  setTimeout(() => {
    if (driving) return warmUp(playground, [first, ...others]);
    playground["ask"]!("document", first);
    warmUp(playground, others);
  }, WARM);
}

const pause = (milliseconds: number): Promise<void> => new Promise((done) => setTimeout(done, milliseconds));

/** Steps a run until it's over or another one began, and lets what the page asks come between. */
async function drive(playground: Playground): Promise<void> {
  const own = ++turn;
  driving++;
  let last = performance.now();
  let owed = 0; // seconds of the mission
  while (own === turn) {
    const now = performance.now();
    owed = Math.min(owed + ((now - last) / 1000) * speed, Math.max(1, speed) * PERIOD * BEHIND, 1);
    last = now;
    if (owed >= PERIOD) {
      const run = JSON.parse(playground["advance"]!(owed, PATIENCE));
      owed -= run.passed ?? 0;
      reply({ run });
      if (run.over || run.problem) turn++;
    }
    await pause(owed >= PERIOD ? 0 : IDLE);
  }
  driving--;
}

reply({ stage: "python" });
const started = start();
started.then(
  (playground) => {
    reply({ stage: "ready" });
    warmUp(playground, MISTAKES);
  },
  (error: Error) => reply({ id: 0, answer: { ok: false, problem: error.message } }),
);

// Playground never raises: what does come here is Python's own end, as where a text is nested too deeply for its stack.
addEventListener("unhandledrejection", (event) => {
  event.preventDefault();
  reply({ broken: true });
});

addEventListener("message", async ({ data }: MessageEvent<Request>) => {
  const playground = await started.catch(() => null);
  if (!playground) return;
  const { id, does, given } = data;
  if (does === "speed") speed = given[0] as number;
  if (does === "stop" || does === "begin") turn++;
  const answer = does === "speed" ? {} : JSON.parse(playground[does]!(...given));
  reply({ id, answer });
  if (does === "begin" && answer.ok) void drive(playground);
});
