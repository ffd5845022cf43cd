// Python in its worker, as the page sees it: questions with answers, and a worker that hangs is exchanged for another one.
import type { Reply, Request } from "./worker";

type Does = Request["does"];

/** What is heard without a question: how far the start is, what happens in a run, and why the worker was exchanged. */
export interface Listener {
  stage: (stage: "python" | "words" | "ready") => void;
  run: (run: any) => void;
  failed: (problem: string) => void;
  exchanged: (why: "broken" | "slow" | "unstopped") => void;
}

const PATIENCE: Partial<Record<Does, number>> = { stop: 4000 };
const USUAL = 15_000; // milliseconds for an answer, once Python has started

export class Python {
  private worker!: Worker;
  private waiting = new Map<number, (answer: any) => void>();
  private timers = new Map<number, ReturnType<typeof setTimeout>>();
  private last = 0;
  private ready!: Promise<void>;
  private started!: () => void;

  constructor(
    private address: string | URL,
    private listener: Listener,
  ) {
    this.start();
  }

  /** The answer to a question; `{ ok: false }` if the worker was exchanged meanwhile. */
  ask(does: Does, ...given: unknown[]): Promise<any> {
    const id = ++this.last;
    return new Promise((done) => {
      this.waiting.set(id, done);
      this.worker.postMessage({ id, does, given } satisfies Request);
      void this.ready.then(() => {
        if (this.waiting.has(id)) this.timers.set(id, setTimeout(() => this.exchange(does === "stop" ? "unstopped" : "slow"), PATIENCE[does] ?? USUAL));
      });
    });
  }

  /** Ends the worker, whatever it does, and starts another one. */
  private exchange(why: "broken" | "slow" | "unstopped"): void {
    this.worker.terminate();
    const open = [...this.waiting.values()];
    this.waiting.clear();
    for (const timer of this.timers.values()) clearTimeout(timer);
    this.timers.clear();
    this.start();
    this.listener.exchanged(why);
    for (const done of open) done({ ok: false, exchanged: true });
  }

  private start(): void {
    this.ready = new Promise((done) => (this.started = done));
    this.worker = new Worker(this.address, { type: "module" });
    this.worker.addEventListener("message", ({ data }: MessageEvent<Reply>) => this.hear(data));
    this.worker.addEventListener("error", (event) => {
      event.preventDefault();
      this.listener.failed(event.message);
    });
  }

  private hear(data: Reply): void {
    if ("stage" in data) {
      if (data.stage === "ready") this.started();
      this.listener.stage(data.stage);
    } else if ("run" in data) this.listener.run(data.run);
    else if ("broken" in data) this.exchange("broken");
    else if (!data.id) this.listener.failed(data.answer.problem);
    else {
      clearTimeout(this.timers.get(data.id));
      this.timers.delete(data.id);
      this.waiting.get(data.id)?.(data.answer);
      this.waiting.delete(data.id);
    }
  }
}
