// What the server understands of the text, always of the newest one: one request at a time, none for what is old by then.
import { post, RequestError } from "../api";
import type { TreeNode } from "../tree/tree_view";

/** A change of the text: characters, and what takes their place. */
export interface Change {
  start: number;
  end: number;
  text: string;
}

/** A message about the text; see `as_data` in btlang/diagnostics/report.py. */
export interface Message {
  code: string;
  severity: "error" | "warning" | "note";
  message: string;
  hint: string;
  start: number;
  end: number;
  fix: Change | null;
  readings: Change[];
}

export interface Named {
  name: string;
  kind: string;
  start: number;
  end: number;
}

/** A node of the tree with the characters that say it. */
export interface SaidNode extends TreeNode {
  start: number | null;
  end: number | null;
  sort?: "command" | "condition";
  /** What can be changed of it: a port, its type, and the words of its value. */
  values?: [port: string, kind: string, words: string][];
}

/** What an answer says went wrong. */
export function problemOf(answer: any): string {
  return answer.messages?.[0]?.message ?? answer.text ?? "";
}

/** Who is told of a text: first what is wrong with it, then its tree if it compiles. */
export interface Listener {
  checked: (text: string, messages: Message[], compiles: boolean, sort: string) => void;
  understood: (text: string, nodes: SaidNode[], outline: Named[]) => void;
  failed: (problem: string) => void;
}

/** A list of which a part is as before; see `ShownDocuments.shorten` in btlang/server/page/shown_documents.py. */
interface Difference<Item> {
  head: number;
  tail: number;
  items: Item[];
}

type Placed = { start: number | null; end: number | null; of?: [number, number]; parent?: number };

/** A list after a change of its text: [start, end, units more]. Nodes come in preorder, so that their levels say their parents. */
export function patched<Item extends Placed>(before: Item[], { head, tail, items }: Difference<Item>, [start, end, longer]: [number, number, number]): Item[] {
  const moved = <Place extends number | null>(place: Place): Place => (place === null || place <= start || place < end ? place : ((place + longer) as Place));
  const levels: number[] = [];
  before.forEach(({ parent = -1 }) => levels.push(parent < 0 ? 0 : levels[parent]! + 1));
  const latest: number[] = []; // of each level
  const after: Item[] = [];
  const add = (item: Item, level: number): void => {
    latest[level] = after.length;
    levelsNow.push(level);
    after.push(item);
  };
  const levelsNow: number[] = [];
  const keep = (from: number, to: number): void => {
    for (let at = from; at < to; at++) {
      const item: Item = { ...before[at]!, start: moved(before[at]!.start), end: moved(before[at]!.end) };
      if (item.of) item.of = [moved(item.of[0]), moved(item.of[1])];
      const level = levels[at]!;
      if (item.parent !== undefined) item.parent = level ? latest[level - 1]! : -1;
      add(item, level);
    }
  };
  keep(0, head);
  for (const item of items) add(item, (item.parent ?? -1) < 0 ? 0 : levelsNow[item.parent!]! + 1);
  keep(before.length - tail, before.length);
  return after;
}

/** What the page has of the latest document, which the server names. */
class Shown {
  private name = "";
  private nodes: SaidNode[] = [];
  private outline: Named[] = [];

  /** What to ask for: what it lacks. */
  get asked(): object {
    return { shown: this.name };
  }

  /** The nodes with what is said once for all of a kind, and the outline. */
  take(answer: any): [SaidNode[], Named[]] {
    const { change } = answer;
    const whole = (nodes: any[]): SaidNode[] => nodes.map((node) => ({ ...node, ...answer.kinds[node.kind] }));
    const { nodes } = answer;
    this.nodes = change ? patched(this.nodes, { ...nodes, items: whole(nodes.items) }, change) : whole(nodes);
    this.outline = change ? patched(this.outline, answer.outline, change) : answer.outline;
    this.name = answer.shown ?? "";
    return [this.nodes.map((node) => ({ ...node })), this.outline];
  }
}

function pause(milliseconds: number): Promise<void> {
  return new Promise((done) => setTimeout(done, milliseconds));
}

/** Asks about texts of one robot. */
export class Reader {
  private page = crypto.randomUUID?.() ?? String(Math.random());
  private text: string | null = null;
  private shown = new Shown();
  private busy = false;
  private ended = false;
  private retry: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private robot: string,
    private listener: Listener,
  ) {}

  /** Asks about a text, of which the listener is told, unless there is a newer one by then. */
  read(text: string): void {
    this.text = text;
    if (!this.busy) void this.ask();
  }

  /** Something else about a text: an answer of the server, or null if it can't be had. */
  async service(kind: string, text: string, more: object): Promise<any> {
    try {
      return await post(`/api/${kind}`, { ...this.asked(text), ...more });
    } catch (error) {
      return error instanceof RequestError && error.data.messages ? error.data : { ok: false, messages: [], text: (error as Error).message };
    }
  }

  close(): void {
    this.ended = true;
    clearTimeout(this.retry);
  }

  private asked(text: string): object {
    return { text, page: this.page, ...(this.robot ? { robot: this.robot } : {}) };
  }

  private async ask(): Promise<void> {
    this.busy = true;
    while (this.text !== null && !this.ended) {
      const text = this.text;
      this.text = null;
      const isNewest = (): boolean => this.text === null && !this.ended;
      const began = performance.now();
      try {
        const { ok, messages, sort } = await post("/api/messages", this.asked(text));
        if (!isNewest()) continue;
        this.listener.checked(text, messages, ok, sort);
        this.listener.failed("");
        await pause(performance.now() - began); // of a long text somebody who types sees messages, and the tree when he stops
        if (!isNewest()) continue;
        const answer = ok && (await post("/api/document", { ...this.asked(text), ...this.shown.asked }));
        if (!answer.nodes) continue;
        const found = this.shown.take(answer);
        if (isNewest()) this.listener.understood(text, ...found);
      } catch (error) {
        if (isNewest()) {
          this.listener.failed((error as Error).message);
          const again = error instanceof RequestError && (error.status === 0 || error.status >= 500);
          if (again) this.retry = setTimeout(() => this.read(text), 1000);
        }
      }
    }
    this.busy = false;
  }
}
