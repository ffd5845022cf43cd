// A button that is held while somebody speaks to the robot's microphone.
import { may } from "../api";
import { h, set } from "../dom";
import type { Robot } from "../fleet";
import { command } from "../tasks/queue";
import { t } from "../texts";
import type { Context } from "../view";

const AGAIN = 1000; // milliseconds: two seconds after the last time the robot listens no more

export class Talk {
  private problem = h("p", { class: "problem", role: "alert" });
  private button = h(
    "button",
    {
      type: "button",
      class: "talk",
      "aria-pressed": "false",
      onpointerdown: (event: PointerEvent) => {
        if (event.button === 0) this.hold();
      },
      onpointerup: () => this.release(),
      onpointercancel: () => this.release(),
      onpointerleave: () => this.release(),
      onblur: () => this.release(),
      oncontextmenu: (event: Event) => event.preventDefault(),
      onkeydown: (event: KeyboardEvent) => {
        if (event.key !== " " && event.key !== "Enter") return;
        event.preventDefault();
        this.hold();
      },
      onkeyup: () => this.release(),
    },
    t("talk"),
  );
  readonly element = h("div", { class: "talking", hidden: true }, this.button, this.problem);
  private timer = 0;

  constructor(private context: Context) {}

  /** What is known of the robot by now. */
  show(robot: Robot): void {
    this.element.hidden = !may(this.context.me, "operator") || !robot.up || !robot.state?.talks;
    if (this.element.hidden) this.release();
  }

  close(): void {
    this.release();
  }

  private hold(): void {
    if (this.timer) return;
    this.timer = window.setInterval(() => void this.send("hold"), AGAIN);
    set(this.button, { "aria-pressed": "true" });
    void this.send("hold");
  }

  private release(): void {
    if (!this.timer) return;
    window.clearInterval(this.timer);
    this.timer = 0;
    set(this.button, { "aria-pressed": "false" });
    void this.send("release");
  }

  private async send(act: string): Promise<void> {
    try {
      await command(this.context, "talk", { act });
      this.problem.textContent = "";
    } catch (error) {
      this.problem.textContent = (error as Error).message;
    }
  }
}
