// All robots: which are up, what they do, and the way to each.
import { address } from "./address";
import { fill, h, oncePerFrame } from "./dom";
import type { Robot } from "./fleet";
import { t } from "./texts";
import type { Context, View } from "./view";

/** See `View`. */
export function openRobots({ fleet }: Context): View {
  const list = h("ul", { class: "robots" });
  const draw = oncePerFrame(() => {
    const robots = [...fleet.robots.values()].sort((a, b) => a.name.localeCompare(b.name));
    const shown = JSON.stringify(robots.map((robot) => [robot.name, state(robot)]));
    if (list.dataset["shown"] === shown) return;
    list.dataset["shown"] = shown;
    fill(list, ...robots.map(card));
    if (!robots.length) fill(list, h("li", { class: "empty" }, t("robots.none"), " ", h("code", {}, "btc robot up")));
  });
  draw();
  const unwatch = fleet.watch(draw);
  return { element: h("section", { class: "page" }, h("h1", {}, t("robots")), list), close: unwatch };
}

function card(robot: Robot): HTMLElement {
  const [kind, text] = state(robot);
  return h("li", {}, h("a", { class: "card", href: address("robots", robot.name) }, h("strong", { dir: "auto" }, robot.name), h("span", { class: `pill ${kind}` }, text)));
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
  if (robot.state?.hindrance) return ["bad", robot.state.hindrance + charge];
  return ["good", t(robot.doing.task ? "robot.working" : "robot.ready") + charge];
}
