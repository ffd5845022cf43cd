// What happened on a robot, in words.
import { h } from "../dom";
import type { Entry } from "../fleet";
import { moment, t, type Key } from "../texts";

const NEWEST = 200;
const SAID: Record<string, Key> = {
  RUNNING: "log.running", SUCCESS: "log.success", FAILURE: "log.failure", SKIPPED: "log.skipped",
  say: "log.say", print: "log.print", navigate: "log.navigate", choose: "log.choose", arrive: "log.arrive", bump: "log.bump",
  stuck: "log.stuck", stop: "log.stop", grasp: "log.grasp", release: "log.release", drop: "log.drop", dock: "log.dock",
  undock: "log.undock", battery: "log.battery", fault: "log.fault", warning: "log.warning", error: "log.error",
};
const BAD = new Set(["FAILURE", "bump", "stuck", "drop", "battery", "fault", "warning", "error"]);

/** An event in words, "" for one that only programs need. */
export function inWords(event: Record<string, any>): string {
  if (event["event"] === "end") {
    if (event["stopped"]) return t("log.ended", { why: event["stopped"] });
    return event["outcome"] === "FAILURE" ? t("log.failed", { why: event["reason"] ?? "" }) : event["outcome"] === "SUCCESS" ? t("log.succeeded") : "";
  }
  const key = SAID[event["event"]];
  return key ? t(key, event) : "";
}

/** The log, of which only the newest lines are shown. New ones come at its end. */
export class LogView {
  readonly element = h("div", { class: "log", role: "log", "aria-label": t("log"), tabindex: 0 });
  private last: Entry | null = null;
  private lastWords = "";

  /** Adds what is new. */
  update(entries: Entry[]): void {
    const known = this.last ? entries.lastIndexOf(this.last) : -1;
    const fresh = entries.slice(known + 1).slice(-NEWEST);
    const atEnd = this.element.scrollTop + this.element.clientHeight >= this.element.scrollHeight - 4;
    for (const entry of fresh) {
      const words = inWords(entry.event);
      if (!words || words === this.lastWords) continue; // several parts of a robot say that they were stopped
      this.lastWords = words;
      this.element.append(
        h("p", { class: BAD.has(entry.event["event"]) ? "bad" : null }, h("time", {}, moment(entry.wall)), h("span", { dir: "auto" }, words)),
      );
    }
    while (this.element.childElementCount > NEWEST) this.element.firstElementChild!.remove();
    this.last = entries.at(-1) ?? this.last;
    if (atEnd) this.element.scrollTop = this.element.scrollHeight;
  }
}
