// The missions of the robot's library, to be begun by one click while it has nothing to do.
import { may } from "../api";
import { fill, h } from "../dom";
import type { Robot } from "../fleet";
import { libraryOf } from "../tasks/library";
import { command } from "../tasks/queue";
import { t } from "../texts";
import type { Context } from "../view";

const MOST = 12; // that are offered

export class Offers {
  private list = h("div", { class: "choices" });
  private problem = h("p", { class: "problem", role: "alert" });
  readonly element = h("div", { class: "starts card", role: "group", "aria-label": t("offers"), hidden: true }, h("h2", { "aria-hidden": true }, t("offers")), this.list, this.problem);
  private names: string[] = [];
  private busy = true; // for all that is known

  constructor(private context: Context) {
    if (may(context.me, "operator")) void this.ask();
  }

  /** What is known of the robot by now, and whether it has a task. */
  show(robot: Robot, busy: boolean): void {
    this.busy = busy;
    this.element.hidden = busy || !robot.up || !this.names.length || Boolean(robot.state?.stopped);
  }

  private async ask(): Promise<void> {
    const missions = await libraryOf(this.context.robot).catch(() => []);
    this.names = missions.map(({ name }) => name);
    const button = (name: string): HTMLElement => h("button", { type: "button", dir: "auto", onclick: () => void this.begin(name) }, name.replaceAll("_", " "));
    fill(this.list, ...this.names.slice(0, MOST).map(button));
    this.show(this.context.fleet.get(this.context.robot), this.busy);
  }

  private async begin(name: string): Promise<void> {
    fill(this.problem);
    this.list.inert = true; // until it's begun: a second click would queue it twice
    try {
      await command(this.context, "submit", { name });
    } catch (error) {
      fill(this.problem, (error as Error).message);
    } finally {
      this.list.inert = false;
    }
  }
}
