// What the robot asks, with the ways to answer it.
import { fill, h } from "../dom";
import type { Robot } from "../fleet";
import { t, type Key } from "../texts";

const LONGEST = 500; // characters of an answer
const LISTENS = "..."; // in place of a question, where the robot only listens

export class Question {
  private words = h("p", { class: "asks", dir: "auto", role: "status" });
  private text = h("input", { dir: "auto", maxlength: LONGEST, autocomplete: "off", required: true, "aria-label": t("question.answer") });
  private problem = h("p", { class: "problem", role: "alert" });
  private form = h(
    "form",
    { onsubmit: (event: Event) => void (event.preventDefault(), this.answer(this.text.value)) },
    this.text,
    h("button", { class: "primary" }, t("question.send")),
    this.button("question.yes", "yes"),
    this.button("question.no", "no"),
    this.problem,
  );
  readonly element = h("div", { class: "question" }, this.words, this.form);
  private shown = "";

  /** `send` gives an answer to the robot; without it the questions are only shown. */
  constructor(private send: ((text: string) => Promise<unknown>) | null) {
    this.form.hidden = true;
  }

  /** What is known of the robot by now. */
  show(robot: Robot): void {
    const asking = robot.up ? robot.asking : "";
    if (asking === this.shown) return;
    this.shown = asking;
    fill(this.words, asking && (asking === LISTENS ? t("question.listens") : t("question.asks", { text: asking })));
    fill(this.problem);
    this.text.value = "";
    this.form.hidden = !asking || !this.send;
  }

  private button(key: Key, text: string): HTMLElement {
    return h("button", { type: "button", onclick: () => void this.answer(text) }, t(key));
  }

  private async answer(text: string): Promise<void> {
    fill(this.problem);
    try {
      await this.send?.(text);
      this.text.value = "";
    } catch (error) {
      fill(this.problem, (error as Error).message);
    }
  }
}
