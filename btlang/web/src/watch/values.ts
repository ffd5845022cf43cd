// Values over the time of the mission under way, or since somebody watches it.
import { fill, h } from "../dom";
import type { Kind, Robot } from "../fleet";
import { Plots, Values } from "../look_back/plots";
import { moment, t } from "../texts";

const now = (): number => performance.now() / 1000;

export class LiveValues {
  private plots = new Plots();
  private since = h("small", {});
  readonly element = h("div", { class: "card values", hidden: true }, h("h2", {}, t("plots"), this.since), this.plots.element);
  private values!: Values;
  private began = 0;

  constructor(private robot: Robot) {
    this.begin();
    for (const kind of ["robot", "scan", "values"] as const) this.note(kind);
  }

  /** Takes in that a message of some kind has come. */
  note(kind: Kind): void {
    const { robot, values } = this;
    const seconds = now() - this.began;
    if (kind === "robot") values.battery(seconds, robot.state?.battery ?? null);
    else if (kind === "scan") values.scan(seconds, robot.scan?.ranges ?? []);
    else if (kind === "values") for (const [name, value] of Object.entries(robot.values)) values.count(seconds, name, value);
    else if (kind === "ages" || kind === "old") this.draw(seconds);
  }

  /** Another mission begins. */
  begin(): void {
    this.began = now();
    this.values = new Values();
    fill(this.since, t("plots.since", { time: moment(Date.now() / 1000) }));
    this.note("robot");
    this.draw(0);
  }

  private draw(seconds: number): void {
    const { series } = this.values;
    this.element.hidden = !series.length;
    this.element.classList.toggle("stale", this.robot.age !== 0);
    this.plots.draw(series, seconds, seconds - (this.robot.age ?? 0));
    this.plots.show(seconds);
  }
}
