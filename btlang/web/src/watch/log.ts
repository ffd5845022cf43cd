// What happened on a robot, in words.
import { h } from "../dom";
import type { Entry } from "../fleet";
import { moment, t, type Key } from "../texts";

const NEWEST = 200;
const PERIOD = 200; // milliseconds
const SAID: Record<string, Key> = {
  RUNNING: "log.running", SUCCESS: "log.success", FAILURE: "log.failure", SKIPPED: "log.skipped",
  say: "log.say", print: "log.print", navigate: "log.navigate", choose: "log.choose", arrive: "log.arrive", bump: "log.bump",
  stuck: "log.stuck", stop: "log.stop", grasp: "log.grasp", release: "log.release", drop: "log.drop", dock: "log.dock",
  come: "log.come", leave: "log.leave", see: "log.see", give: "log.give", picture: "log.picture", call: "log.call", undock: "log.undock", battery: "log.battery", fault: "log.fault", part: "log.part", warning: "log.warning", error: "log.error",
};
const BAD = new Set(["FAILURE", "bump", "stuck", "drop", "battery", "fault", "warning", "error"]);

/** An event in words, "" for one that only programs need. */
export function inWords(event: Record<string, any>): string {
  if (event["event"] === "end") {
    if (event["stopped"]) return t("log.ended", { why: event["stopped"] });
    return event["outcome"] === "FAILURE" ? t("log.failed", { why: event["reason"] ?? "" }) : event["outcome"] === "SUCCESS" ? t("log.succeeded") : "";
  }
  if (event["event"] === "part" && !event["text"]) return "";
  const key = SAID[event["event"]] ?? manner(event);
  return key ? t(key, event) : "";
}

/** The words of an event that says one of several things. */
function manner(event: Record<string, any>): Key | undefined {
  const { event: kind, who, text, open, on } = event;
  if (kind === "hear") return who ? "log.hear_from" : "log.hear";
  if (kind === "ask") return !text ? "log.listen" : who ? "log.ask_person" : "log.ask";
  if (kind === "door") return open ? "log.door_open" : "log.door_closed";
  if (kind === "switch") return on ? "log.switch_on" : "log.switch_off";
  return undefined;
}

/** The log, of which only the newest lines are shown. New ones come at its end. */
export class LogView {
  private lines = h("ol");
  readonly element = h("div", { class: "log", role: "log", "aria-label": t("log"), tabindex: 0 }, this.lines);
  private last: Entry | null = null;
  private lastWords = "";
  private atEnd = true;
  private entries: Entry[] = [];
  private timer = 0;

  constructor() {
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
      this.lines.append(
        h("li", { class: BAD.has(entry.event["event"]) ? "bad" : null }, h("time", {}, moment(entry.wall)), h("span", { dir: "auto" }, words)),
      );
    }
    while (this.lines.childElementCount > NEWEST) this.lines.firstElementChild!.remove();
    this.last = entries.at(-1) ?? this.last;
    if (this.atEnd && fresh.length) this.element.scrollTop = this.element.scrollHeight;
  }
}
