// A run at one moment: its tree, its map, its story, and the words of a node.
import { fill, h, oncePerFrame } from "../dom";
import { Robot, STATUSES, type Point, type Status, type Thing, type WorldMap } from "../fleet";
import { t } from "../texts";
import { TreeView, joined, type TreeNode } from "../tree/tree_view";
import { MapView } from "../watch/map";
import { clock } from "./timeline";

/** See Film.data in btlang/recording/film.py. */
export interface Film {
  about: Record<string, string>;
  text: string;
  names: Status[];
  nodes: (TreeNode & { start: number | null; end: number | null })[];
  words: [t: number, node: number, words: string][];
  statuses: number[][];
  robot: [t: number, x: number | null, y: number | null, heading: number | null, battery: number | null, left: string | null, right: string | null][];
  things: [t: number, ...Thing][];
  events: Record<string, any>[];
  story: [t: number, node: number, words: string][];
  map: WorldMap;
  why: string;
  failed: number;
  seconds: number;
  is_cut: boolean;
  stopped?: string;
}

export class Scene {
  readonly tree: TreeView;
  readonly place: HTMLElement;
  readonly log: HTMLElement;
  readonly words = h("pre", { class: "film-text", tabindex: 0, dir: "auto", lang: "en", "aria-label": t("write.text") });
  /** How it ended, and why. */
  readonly outcome: HTMLElement;
  private robot = new Robot("film");
  private map = new MapView(() => this.robot);
  private story = h("ol", { class: "log story", lang: "en", tabindex: 0 });
  private now = 0;
  private taken = 0; // statuses that the tree shows
  private said = 0; // words that it shows
  private draw = oncePerFrame(() => this.show());

  /** `jump` is told what somebody chose in the story: a time, in seconds, and a node (-1: none). */
  constructor(
    readonly film: Film,
    jump: (seconds: number, node: number) => void,
    selected: (node: number) => void = () => undefined,
  ) {
    this.robot.map = film.map;
    this.tree = new TreeView({ label: t("watch.tree"), select: (node) => { this.showWords(node); selected(node); } });
    const items = film.story.map(([seconds, node, words]) =>
      h("li", {}, h("time", {}, clock(seconds)), h("button", { type: "button", class: "plain", onclick: () => jump(seconds, node) }, words)),
    );
    fill(this.story, ...items);
    this.place = h("div", { class: "card place" }, this.map.canvas);
    this.log = h("div", { class: "card events" }, h("h2", {}, t("log")), this.story);
    const words = [film.stopped && `${t("film.stopped")} ${film.stopped}.`, film.why, film.is_cut && t("film.cut")].filter(Boolean).join("\n");
    this.outcome = h("p", { class: film.failed >= 0 || film.stopped ? "outcome bad" : "outcome", lang: "en", tabindex: 0 }, words);
    this.tree.setNodes(joined(film.nodes));
    this.showWords(-1);
  }

  close(): void {
    this.tree.close();
    this.map.close();
  }

  /** Shows a moment, in seconds. */
  seek(seconds: number): void {
    this.now = Math.min(Math.max(seconds, 0), this.film.seconds);
    this.draw();
  }

  select(node: number): void {
    if (node < 0) return;
    this.tree.select(node);
    this.showWords(node);
  }

  /** When a node failed last. */
  timeOf(node: number): number {
    const failure = this.film.names.indexOf("FAILURE");
    const found = this.film.statuses.findLast((row) => row.some((each, at) => at % 2 === 1 && each === node && row[at + 1] === failure));
    return found?.[0] ?? this.film.seconds;
  }

  private show(): void {
    const { film, now } = this;
    if (this.taken && film.statuses[this.taken - 1]![0]! > now) {
      this.taken = 0;
      this.tree.setStatuses(film.nodes.map((_, index) => [index, STATUSES[0]] as const));
    }
    const changes = new Map<number, Status>();
    while (this.taken < film.statuses.length && film.statuses[this.taken]![0]! <= now + 1e-6) {
      const row = film.statuses[this.taken++]!;
      for (let at = 1; at < row.length; at += 2) changes.set(row[at]!, film.names[row[at + 1]!]!);
    }
    this.tree.setStatuses(changes);
    this.showValues();
    this.showRobot();
    const current = film.story.findLastIndex(([seconds]) => seconds <= now + 1e-6);
    [...this.story.children].forEach((item, index) => item.classList.toggle("now", index === current));
  }

  /** What the nodes say with the values of this moment. */
  private showValues(): void {
    const { film, now } = this;
    if (this.said && film.words[this.said - 1]![0] > now) {
      this.said = 0;
      this.tree.setWords(film.words.map(([, node]) => [node, film.nodes[node]!.label] as const));
    }
    const words = new Map<number, string>();
    while (this.said < film.words.length && film.words[this.said]![0] <= now + 1e-6) {
      const [, node, said] = film.words[this.said++]!;
      words.set(node, said);
    }
    this.tree.setWords(words);
  }

  private showRobot(): void {
    const { film, robot, now } = this;
    const count = film.robot.findLastIndex((row) => row[0] <= now) + 1;
    const latest = film.robot[count - 1];
    robot.path = film.robot.slice(0, count).flatMap(([, x, y]): Point[] => (x === null || y === null ? [] : [[x, y]]));
    if (latest) {
      const [, x, y, heading, battery, left, right] = latest;
      robot.state = { stopped: "", paused: false, hindrance: "", pose: x === null || y === null ? null : [x, y, heading ?? 0], battery, left, right };
    }
    const things = new Map<string, Thing>();
    for (const [seconds, ...thing] of film.things) {
      if (seconds > now) break;
      things.set(thing[0], thing);
    }
    robot.things = [...things.values()];
    const moved = film.events.filter((event) => event["event"] === "door" && event["t"] <= now);
    const doors = new Map(moved.map((event) => [event["name"], event["open"]]));
    robot.map = { ...film.map, doors: film.map.doors?.map((door) => ({ ...door, open: doors.get(door.name) ?? door.open })) };
    this.map.redraw();
  }

  private showWords(node: number): void {
    const { text, nodes } = this.film;
    const said = nodes[node];
    if (!said || said.start === null || said.end === null) return fill(this.words, text);
    const mark = h("mark", {}, text.slice(said.start, said.end));
    fill(this.words, text.slice(0, said.start), mark, text.slice(said.end));
    mark.scrollIntoView({ block: "nearest" });
  }
}
