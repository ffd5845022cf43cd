// The body of a robot with links, in 3D; what draws it is loaded for such a robot alone.
import { requestText } from "../api";
import type { BodyView } from "../body/body_view";
import { fill, h } from "../dom";
import type { Robot } from "../fleet";
import { state } from "../robots";
import { t } from "../texts";
import type { Context } from "../view";
import { spoken } from "./speech";

const GAP = 6; // pixels between the bubble and the body
const SENTENCE = /[^.!?]*[.!?]*\s*/g;

export class Body {
  private bubble = h("p", { class: "bubble", dir: "auto", "aria-hidden": true, hidden: true });
  private problem = h("p", { class: "empty", role: "status", hidden: true });
  readonly element = h("div", { class: "body", hidden: true });
  private canvas: HTMLCanvasElement | null = null;
  private view: BodyView | null = null;
  private turn = 0; // of those that were begun

  constructor(private context: Context) {}

  /** What is known of the robot by now, and what it does, in words. */
  show(robot: Robot, does: string): void {
    if (!robot.joints.length) return;
    if (!this.canvas) void this.begin();
    this.view?.show(robot);
    const says = robot.speech.text;
    this.canvas?.setAttribute("aria-label", t("body", { robot: robot.name, does: [does, says && t("log.say", { text: says })].filter(Boolean).join("; ") || state(robot)[1] }));
    this.showBubble(robot);
  }

  /** Ends the picture; `show` begins another one. */
  close(): void {
    this.turn++;
    this.view?.close();
    this.view = this.canvas = null;
    this.element.hidden = true;
  }

  private async begin(): Promise<void> {
    const turn = ++this.turn;
    const canvas = (this.canvas = h("canvas", { tabindex: 0, role: "application", title: t("body.keys") }));
    canvas.addEventListener("webglcontextlost", () => turn === this.turn && this.fail(t("body.lost")));
    fill(this.element, canvas, this.bubble, this.problem);
    this.element.hidden = false;
    this.problem.hidden = this.bubble.hidden = true;
    const context = canvas.getContext("webgl2", { antialias: true });
    if (!context) return this.fail(t("body.none"));
    try {
      const urdf = requestText(`/api/urdf?robot=${encodeURIComponent(this.context.robot)}`);
      const { BodyView } = await import("../body/body_view");
      const text = await urdf;
      if (turn !== this.turn) return;
      this.view = new BodyView(canvas, context, text, (x, y) => this.place(x, y));
      this.view.show(this.context.fleet.get(this.context.robot));
    } catch (error) {
      if (turn === this.turn) this.fail(t("body.unread", { why: (error as Error).message }));
    }
  }

  private fail(why: string): void {
    this.view?.close();
    this.view = null;
    this.canvas?.remove();
    this.bubble.hidden = true;
    this.problem.hidden = false;
    fill(this.problem, why);
  }

  /** The sentence of now. */
  private showBubble(robot: Robot): void {
    const [before, word, after] = spoken(robot.speech);
    this.bubble.hidden = !this.view || !robot.speech.text;
    if (this.bubble.hidden) return;
    const first = before.match(SENTENCE)?.findLast((each) => each && !/[.!?]\s+$/.test(each)) ?? "";
    fill(this.bubble, first, h("mark", {}, word), after.match(SENTENCE)?.[0] ?? "");
  }

  private place(x: number, y: number): void {
    const half = this.bubble.offsetWidth / 2 + GAP;
    this.bubble.style.left = `${Math.max(Math.min(x, this.element.clientWidth - half), half)}px`;
    this.bubble.style.top = `${Math.max(y - this.bubble.offsetHeight - GAP, GAP)}px`;
  }
}
