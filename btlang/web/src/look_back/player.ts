// A film of a run, of a recording or of a trial: its tree, map and story at any moment, and the words of each node.
import { fill, h, oncePerFrame, set } from "../dom";
import { Robot, STATUSES, type Point, type Status, type WorldMap } from "../fleet";
import { t } from "../texts";
import { TreeView, type TreeNode } from "../tree/tree_view";
import { MapView } from "../watch/map";

/** See Film.data in btlang/recording/film.py. */
export interface Film {
  text: string;
  names: Status[];
  nodes: (TreeNode & { start: number | null; end: number | null })[];
  statuses: number[][];
  robot: [t: number, x: number | null, y: number | null, heading: number | null, battery: number | null, left: string | null, right: string | null][];
  story: [t: number, node: number, words: string][];
  map: WorldMap;
  why: string;
  failed: number;
  seconds: number;
  is_cut: boolean;
  stopped?: string;
}

const SPEEDS = [1, 4, 20];

export class Player {
  readonly element: HTMLElement;
  private robot = new Robot("film");
  private tree = new TreeView({ label: t("watch.tree"), select: (node) => this.showWords(node) });
  private map = new MapView(() => this.robot);
  private words = h("pre", { class: "film-text", tabindex: 0, dir: "auto", lang: "en", "aria-label": t("write.text") });
  private slider = h("input", { type: "range", min: 0, step: "any", "aria-label": t("film.time") });
  private clock = h("output", { class: "clock" });
  private button = h("button", { type: "button", class: "primary", onclick: () => this.toggle() }, t("film.play"));
  private speed = h("select", { "aria-label": t("film.speed") }, ...SPEEDS.map((each) => h("option", { value: each }, `${each}×`)));
  private story = h("ol", { class: "log story", lang: "en", tabindex: 0 });
  private now = 0;
  private taken = 0; // statuses that the tree shows
  private playing = false;
  private last = 0;
  private closed = false;
  private draw = oncePerFrame(() => this.show());

  /** `moved` is told the time, in seconds, when somebody chose it. */
  constructor(
    private film: Film,
    at = 0,
    private moved: (seconds: number) => void = () => undefined,
  ) {
    this.robot.map = film.map;
    set(this.slider, { max: film.seconds });
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.slider.addEventListener("change", () => moved(this.now));
    const items = film.story.map(([seconds, node, words]) =>
      h("li", {}, h("time", {}, clock(seconds)), h("button", { type: "button", class: "plain", onclick: () => this.jump(seconds, node) }, words)),
    );
    fill(this.story, ...items);
    const failure = film.failed >= 0 && h("button", { type: "button", onclick: () => this.jump(this.timeOf(film.failed), film.failed) }, t("film.failure"));
    this.element = h(
      "section",
      { class: "film" },
      h("p", { class: film.failed >= 0 || film.stopped ? "outcome bad" : "outcome", lang: "en", tabindex: 0 }, [film.stopped && `${t("film.stopped")} ${film.stopped}.`, film.why, film.is_cut && t("film.cut")].filter(Boolean).join("\n")),
      h("div", { class: "panes" }, h("div", { class: "stage card" }, this.tree.element), h("div", { class: "side" }, h("div", { class: "card place" }, this.map.canvas), h("div", { class: "card events" }, h("h2", {}, t("log")), this.story), film.text && h("div", { class: "card" }, this.words))),
      h("div", { class: "timeline card" }, this.button, this.slider, this.clock, this.speed, failure),
    );
    this.tree.setNodes(film.nodes);
    this.showWords(-1);
    this.seek(at || (film.failed >= 0 ? this.timeOf(film.failed) : 0));
    if (film.failed >= 0) this.jump(this.now, film.failed, false);
  }

  close(): void {
    this.closed = true;
    this.tree.close();
    this.map.close();
  }

  private jump(seconds: number, node: number, said = true): void {
    this.seek(seconds);
    if (said) this.moved(seconds);
    if (node >= 0) {
      this.tree.select(node);
      this.showWords(node);
    }
  }

  /** When a node failed last. */
  private timeOf(node: number): number {
    const failure = this.film.names.indexOf("FAILURE");
    const found = this.film.statuses.findLast((row) => row.some((each, at) => at % 2 === 1 && each === node && row[at + 1] === failure));
    return found?.[0] ?? this.film.seconds;
  }

  private seek(seconds: number): void {
    this.now = Math.min(Math.max(seconds, 0), this.film.seconds);
    this.draw();
  }

  private toggle(): void {
    this.playing = !this.playing;
    fill(this.button, t(this.playing ? "film.pause" : "film.play"));
    if (!this.playing) return this.moved(this.now);
    if (this.now >= this.film.seconds) this.now = 0;
    this.last = performance.now();
    requestAnimationFrame(() => this.step());
  }

  private step(): void {
    if (!this.playing || this.closed) return;
    const time = performance.now();
    this.seek(this.now + ((time - this.last) / 1000) * Number(this.speed.value));
    this.last = time;
    if (this.now >= this.film.seconds) this.toggle();
    else requestAnimationFrame(() => this.step());
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
    this.showRobot();
    this.slider.value = String(now);
    set(this.slider, { "aria-valuetext": clock(now) });
    fill(this.clock, `${clock(now)} / ${clock(film.seconds)}`);
    const current = film.story.findLastIndex(([seconds]) => seconds <= now + 1e-6);
    [...this.story.children].forEach((item, index) => item.classList.toggle("now", index === current));
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

function clock(seconds: number): string {
  return `${Math.floor(seconds / 60)}:${(seconds % 60).toFixed(1).padStart(4, "0")}`;
}
