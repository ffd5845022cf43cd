// What happened on a robot, in words.
import { h } from "../dom";
import { ALARMS, DEFAULTS } from "../events";
import type { Entry } from "../fleet";
import { KEYS, moment, said, t, type Key } from "../texts";

const NEWEST = 200;
const PERIOD = 200; // milliseconds
const REASONS = ["reason", "stopped"]; // fields that are English
const TEXTS = KEYS.map((key) => [key, key.split(".")] as const).filter(([, [log]]) => log === "log");

/** An event in words, "" for one that only programs need. Of the texts that its fields fit, the last one says it:
 *  "log.ask.text.who" is for a question with `text` and `who`, "log.end.outcome=FAILURE" for an end with that outcome.
 */
export function inWords(event: Entry["event"]): string {
  const fields: Record<string, unknown> = { ...event };
  const values = Object.fromEntries(Object.entries(fields).map(([name, value]) => [name, REASONS.includes(name) ? said(written(value)) : written(value)]));
  const fits = (condition: string): boolean => {
    const [name, wanted] = condition.split("=") as [string, string?];
    return wanted === undefined ? Boolean(values[name]) && fields[name] !== DEFAULTS[event.event]?.[name] : values[name] === wanted;
  };
  const usual: Key = `log.${event.event}`; // so each kind has one: else this isn't a Key
  const [key] = TEXTS.findLast(([, [, kind, ...conditions]]) => kind === event.event && conditions.every(fits)) ?? [usual];
  return t(key, values);
}

/** The value of a field; "" for nothing. */
function written(value: unknown): string {
  if (typeof value === "number") return String(Math.round(value * 100) / 100);
  if (value === null || value === undefined || value === false) return "";
  if (typeof value === "object") return Object.entries(value).map(([name, each]) => `${name} ${written(each)}`).join(", ");
  return String(value);
}

/** The log, of which only the newest lines are shown. New ones come at its end. */
export class LogView {
  private lines = h("ol");
  private empty = h("p", { class: "empty" }, t("watch.from_now"));
  readonly element = h("div", { class: "log", role: "log", "aria-label": t("log"), tabindex: 0 }, this.empty, this.lines);
  private last: Entry | null = null;
  private lastWords = "";
  private atEnd = true;
  private entries: Entry[] = [];
  private timer = 0;

  /** `choose` gets the node of a line that somebody clicks on. */
  constructor(private choose: (node: number) => void) {
    this.element.addEventListener("scroll", () => {
      const { scrollTop, clientHeight, scrollHeight } = this.element;
      this.atEnd = scrollTop + clientHeight >= scrollHeight - 8;
    });
  }

  /** Adds what is new, a few times in a second. */
  update(entries: Entry[]): void {
    this.entries = entries;
    this.timer ||= window.setTimeout(() => this.add(), PERIOD);
  }

  private add(): void {
    this.timer = 0;
    const { entries } = this;
    const known = this.last ? entries.lastIndexOf(this.last) : -1;
    const fresh = entries.slice(known + 1).slice(-NEWEST);
    for (const entry of fresh) {
      const words = inWords(entry.event);
      if (!words || words === this.lastWords) continue; // several parts of a robot say that they were stopped
      this.lastWords = words;
      this.empty.remove();
      this.lines.append(
        h("li", { class: ALARMS.has(entry.event.event) || entry.event.event === "FAILURE" ? "bad" : null }, h("time", {}, moment(entry.wall)), "node" in entry.event && entry.event.node !== undefined
            ? h("button", { type: "button", class: "plain", dir: "auto", onclick: () => entry.task === this.entries.at(-1)?.task && this.choose((entry.event as { node: number }).node) }, words)
            : h("span", { dir: "auto" }, words),
        ),
      );
    }
    while (this.lines.childElementCount > NEWEST) this.lines.firstElementChild!.remove();
    this.last = entries.at(-1) ?? this.last;
    if (this.atEnd && fresh.length) this.element.scrollTop = this.element.scrollHeight;
  }
}
