// Why a mission failed, with the node and the words that did.
import { fill, h } from "../dom";
import type { Entry } from "../fleet";
import { said, t } from "../texts";

const AROUND = 2; // lines of the mission before and after the one that failed

export class Failure {
  readonly element = h("div", { class: "failure", role: "status", hidden: true });

  /** `select` shows the node at a path. */
  constructor(private select: (path: string) => void) {}

  clear(): void {
    this.element.hidden = true;
  }

  /** Shows a failed end, with the lines of the mission around it. */
  note({ task, event }: Entry, text: string, label: string): void {
    if (event.event !== "end" || event.outcome !== "FAILURE" || event.stopped || !task) return;
    const words = h("pre", { class: "words", dir: "auto" });
    fill(
      this.element,
      h("p", {}, h("strong", {}, t("failure", { what: label || event.id })), " ", h("span", { dir: "auto" }, said(event.reason))),
      words,
      event.path && h("button", { type: "button", onclick: () => this.select(event.path) }, t("failure.node")),
    );
    this.element.hidden = false;
    if (event.path) this.select(event.path);
    const line = Number(/(\d+)(?::\d+)?$/.exec(event.place)?.[1] ?? 0);
    if (!line || !text) return;
    const lines = text.split("\n");
    const first = Math.max(1, line - AROUND);
    const near = lines.slice(first - 1, line + AROUND);
    fill(words, ...near.map((text, index) => h(first + index === line ? "mark" : "span", {}, `${String(first + index).padStart(4)}  ${text}\n`)));
  }
}
