// What the robot says, with the word that is spoken now, and what it heard.
import { fill, h } from "../dom";
import type { Robot } from "../fleet";
import { t } from "../texts";

/** The text before, in and after the word of now; indices of the robot count whole characters. */
export function spoken({ text, start, end }: Robot["speech"]): [string, string, string] {
  const letters = [...text];
  return [[0, start], [start, end], [end, letters.length]].map(([from, to]) => letters.slice(from, to).join("")) as [string, string, string];
}

export class Speech {
  private words = h("span", { "aria-hidden": true });
  private whole = h("span", { class: "aside", "aria-live": "polite" });
  private says = h("p", { class: "says", dir: "auto", hidden: true }, this.whole, this.words);
  private heard = h("p", { class: "says heard", dir: "auto", role: "status" });
  readonly element = h("div", { class: "speech" }, this.says, this.heard);
  private shown = "";

  /** What is known of the robot by now. */
  show(robot: Robot): void {
    const shown = JSON.stringify([robot.doing, robot.asking, robot.speech]);
    if (shown === this.shown) return;
    this.shown = shown;
    const text = robot.speech.text || robot.doing.says;
    this.says.hidden = !text || text === robot.asking;
    const [before, word, after] = spoken(robot.speech);
    if (robot.speech.text) fill(this.words, "“", before, h("mark", {}, word), after, "”");
    else fill(this.words, `“${text}”`);
    if (this.whole.textContent !== text) fill(this.whole, text);
    fill(this.heard, robot.doing.heard && t("watch.heard", { text: robot.doing.heard }));
  }
}
