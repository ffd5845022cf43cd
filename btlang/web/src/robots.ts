// All robots: which are up, what they do, and the way to each.
import { address } from "./address";
import { request } from "./api";
import { fill, h, oncePerFrame } from "./dom";
import type { Robot } from "./fleet";
import { said, t } from "./texts";
import type { Context, View } from "./view";
import { MapView } from "./watch/map";

/** See `View`. */
export function openRobots({ fleet }: Context): View {
  const list = h("ul", { class: "robots" });
  const cards = new Map<string, Card>();
  const draw = oncePerFrame(() => {
    const robots = [...fleet.robots.values()].sort((a, b) => a.name.localeCompare(b.name));
    for (const robot of robots) if (!cards.has(robot.name)) cards.set(robot.name, new Card(robot));
    for (const robot of robots) cards.get(robot.name)!.show();
    const shown = JSON.stringify(robots.map(({ name }) => name));
    if (list.dataset["shown"] === shown) return;
    list.dataset["shown"] = shown;
    fill(list, ...robots.map(({ name }) => cards.get(name)!.element));
    if (!robots.length) fill(list, h("li", { class: "empty" }, t("robots.none"), " ", h("code", {}, "btc robot up")));
  });
  draw();
  const unwatch = fleet.watch(draw);
  const close = (): void => {
    unwatch();
    for (const card of cards.values()) card.close();
  };
  return { element: h("section", { class: "page" }, h("h1", {}, t("robots")), list), close };
}

/** A robot in the list: what it does, where it is, and how much its battery has. */
class Card {
  readonly element: HTMLElement;
  private pill = h("span", { class: "pill" });
  private mission = h("span", { class: "mission", dir: "auto" });
  private meter = h("meter", { min: 0, max: 100, low: 20, hidden: true });
  private map: MapView;
  private place: HTMLElement;
  private task = 0; // whose mission is shown
  private closed = false;

  constructor(private robot: Robot) {
    this.map = new MapView(() => robot);
    this.place = h("span", { class: "place", hidden: true }, this.map.canvas);
    const head = h("span", { class: "card-head" }, h("strong", { dir: "auto" }, robot.name), this.pill);
    this.element = h("li", {}, h("a", { class: "card", href: address("robots", robot.name) }, head, this.mission, this.meter, this.place));
  }

  show(): void {
    const { robot } = this;
    const [kind, text] = state(robot);
    this.pill.className = `pill ${kind}`;
    fill(this.pill, text);
    const battery = robot.state?.battery ?? null;
    this.meter.hidden = battery === null;
    this.meter.value = battery ?? 0;
    this.meter.setAttribute("aria-label", t("robot.battery", { percent: Math.round(battery ?? 0) }));
    this.place.hidden = !robot.map;
    this.place.classList.toggle("stale", !robot.up || robot.age !== 0);
    this.map.redraw();
    if (robot.doing.task !== this.task) void this.ask(robot.doing.task);
  }

  close(): void {
    this.closed = true;
    this.map.close();
  }

  /** What the task is called. */
  private async ask(task: number): Promise<void> {
    this.task = task;
    fill(this.mission);
    if (!task) return;
    const answer = await request("POST", "/api/commands", { command: "list", robot: this.robot.name }).catch(() => null);
    const found = (answer?.data.tasks as { id: number; mission: string }[] | undefined)?.find(({ id }) => id === task);
    if (!this.closed && this.task === task) fill(this.mission, found?.mission.replace(/^#+\s*/, "") ?? "");
  }
}

/** How a robot is, as a class and in words. */
export function state(robot: Robot): [kind: "good" | "bad" | "quiet", text: string] {
  if (!robot.up) return ["quiet", t("robot.away")];
  const [kind, text] = latest(robot);
  return robot.age === 0 ? [kind, text] : [kind === "good" ? "quiet" : kind, `${text} · ${oldness(robot)}`];
}

/** How old what is known of a robot is, in words; "" where it is true now. */
export function oldness(robot: Robot): string {
  if (robot.age === null) return t("robot.unread");
  if (robot.age === 0) return "";
  return robot.age < 120 ? t("robot.old", { seconds: robot.age }) : t("robot.very_old", { minutes: Math.floor(robot.age / 60) });
}

function latest(robot: Robot): [kind: "good" | "bad" | "quiet", text: string] {
  const battery = robot.state?.battery;
  const charge = battery === null || battery === undefined ? "" : ` · ${t("robot.battery", { percent: Math.round(battery) })}`;
  if (robot.state?.stopped) return ["bad", t("robot.stopped") + charge];
  if (robot.state?.paused) return ["quiet", t("robot.paused") + charge];
  if (robot.state?.acting) return ["quiet", t("robot.rule") + charge];
  if (robot.state?.hindrance) return ["bad", said(robot.state.hindrance) + charge];
  return ["good", t(robot.doing.task ? "robot.working" : "robot.ready") + charge];
}
