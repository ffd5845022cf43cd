// The trail: who did or tried what, from where, and how it went.
import { request } from "../api";
import { fill, h } from "../dom";
import { more, type MoreKey } from "../more_texts";
import { moment, said, visible } from "../texts";

const STEP = 100; // entries more with each click
const MOST = 1000; // that the server gives
const REST = 250; // milliseconds after a key

interface Entry {
  time: number;
  user: string;
  address: string;
  what: string;
  outcome: string;
}

/** `failed` gets what went wrong. */
export class Trail {
  readonly element: HTMLElement;
  private words = h("input", { type: "search", dir: "auto", maxlength: 200, "aria-label": more("trail.filter"), placeholder: more("trail.filter"), oninput: () => this.later() });
  private failures = h("input", { type: "checkbox", onchange: () => void this.refresh() });
  private count = h("p", { class: "since", role: "status" });
  private list = h("ol", { class: "trail" });
  private further = h("button", { type: "button", hidden: true, onclick: () => { this.limit += STEP; void this.refresh(); } }, more("trail.further"));
  private limit = STEP;
  private timer = 0;
  private turn = 0;

  constructor(private failed: (error: Error) => void) {
    this.element = h(
      "section", { class: "trail-part" },
      h("h2", {}, more("trail")),
      h("div", { class: "filter" }, this.words, h("label", {}, this.failures, more("trail.failures"))),
      this.count, this.list, this.further,
    );
  }

  async refresh(): Promise<void> {
    const turn = ++this.turn;
    const query = new URLSearchParams({ filter: this.words.value, failures: String(this.failures.checked), limit: String(this.limit) });
    try {
      const { entries } = (await request("GET", `/api/trail?${query}`)) as { entries: Entry[] };
      if (turn !== this.turn) return; // it's that of other words
      fill(this.count, entries.length ? more("trail.count", { count: entries.length }) : more("trail.none"));
      fill(this.list, ...entries.map(line));
      this.further.hidden = entries.length < this.limit || this.limit >= MOST;
    } catch (error) {
      if (turn === this.turn) this.failed(error as Error);
    }
  }

  close(): void {
    clearTimeout(this.timer);
    this.turn++;
  }

  private later(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.refresh(), REST);
  }
}

function line({ time, user, address, what, outcome }: Entry): HTMLElement {
  const known = outcome === "ok" || outcome === "wrong" || outcome === "refused";
  return h(
    "li", {},
    h("time", { datetime: new Date(time * 1000).toISOString() }, moment(time)),
    h("span", { class: "who" }, h("strong", { dir: "auto" }, visible(user) || "–"), h("small", {}, ` ${address}`)),
    h("span", { class: "what", dir: "auto" }, visible(said(what))),
    h("span", { class: `pill ${outcome === "ok" ? "good" : "bad"}` }, known ? more(`outcome.${outcome}` as MoreKey) : visible(outcome)),
  );
}
