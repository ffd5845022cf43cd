// A run at one moment: its tree, its map, its story, and the words of a node.
import { fill, h, oncePerFrame, type Child } from "../dom";
import { whole } from "../events";
import { Robot, STATUSES, type Rule, type Status, type Thing, type WorldMap } from "../fleet";
import { said, t, type Key } from "../texts";
import { TreeView, joined, withoutRules, type TreeNode } from "../tree/tree_view";
import { MapView, nodeNaming } from "../watch/map";
import { RuleStrip } from "../watch/rules";
import { Speech } from "../watch/speech";
import { nodeAt, pieces, Words, type Piece, type Place } from "../watch/words";
import { clock } from "./timeline";

/** See Film.data in btlang/recording/film.py. */
export interface Film {
  about: Record<string, string>;
  text: string;
  names: Status[];
  nodes: (TreeNode & { start: number | null; end: number | null })[];
  rules: Rule[];
  root: number;
  words: [t: number, node: number, words: string][];
  statuses: [t: number, ...number[]][];
  robot: [t: number, x: number | null, y: number | null, heading: number | null, battery: number | null, left: string | null, right: string | null][];
  things: [t: number, ...Thing][];
  scans: [t: number, ranges: (number | null)[]][];
  values: [t: number, name: string, value: number][];
  events: { t: number; event: string }[];
  doing: [t: number, task: number, goal: string, says: string, heard: string][];
  story: Noted[];
  map: WorldMap;
  ending: { outcome: string; stopped: string; seconds: number; motion: string; words: string; reason: string; context: string[] };
  failed: number;
  seconds: number;
  is_cut: boolean;
  stopped?: string;
}

/** Something that was done, since a moment; `ending` is "" for what is no node. */
export type Noted = [t: number, node: number, words: string, ending: Exclude<Status, "RUNNING"> | "", reason: string];

/** What was done and how it ended: what succeeded are its words alone. */
export function noted([, , words, ending, reason]: Noted): string {
  const done = ending && ending !== "SUCCESS" ? t(`log.${ending}`, { name: words }) : words;
  return reason ? `${done} (${said(reason)})` : done;
}

/** Rows that begin with their times, in seconds, given out as these come. */
class Rows<Row extends [number, ...unknown[]]> {
  private taken = 0;

  constructor(private rows: Row[]) {}

  /** Those up to a moment that weren't given out yet. */
  *upTo(now: number): Generator<Row> {
    for (let row = this.rows[this.taken]; row && row[0] <= now + 1e-6; row = this.rows[this.taken]) {
      this.taken++;
      yield row;
    }
  }
}

const valuesOf = ({ ports }: TreeNode): string[] => ports.map(([, value]) => value);
const EMERGENCY = "emergency stop";

/** How a run ended, as a class: "bad" where it failed or the emergency stop was pressed, "quiet" where somebody ended it. */
function ending({ failed, stopped, ending }: Film): string {
  if (failed >= 0 || stopped || ending.stopped === EMERGENCY) return "bad";
  return ending.stopped || !ending.outcome ? "quiet" : "";
}

/** How a run ended, in words. */
function inWords({ ending, stopped, is_cut, failed, nodes, text }: Film): Child[] {
  const { outcome, seconds, reason, words, context, motion } = ending;
  const by: Record<string, Key> = { "": outcome ? (`end.${outcome}` as Key) : "end.open", [EMERGENCY]: "end.emergency", interrupted: "end.interrupted" };
  const start = nodes[failed]?.start ?? null;
  const line = start === null ? "" : `${t("write.line", { line: text.slice(0, start).split("\n").length })}: `;
  return [
    h("p", {}, stopped && `${t("film.stopped")} ${stopped}. `, t(by[ending.stopped] ?? "end.stopped", { seconds, by: said(ending.stopped) }), motion && ` ${motion}.`),
    words && h("p", { class: "why" }, h("strong", {}, line), h("span", { dir: "auto" }, `${words}: ${said(reason)}`)),
    context.length > 0 && h("details", {}, h("summary", {}, t("film.context")), h("pre", { lang: "en", dir: "auto" }, context.join("\n"))),
    is_cut && h("p", {}, t("film.cut")),
  ];
}

export class Scene {
  readonly tree: TreeView;
  readonly place: HTMLElement;
  readonly log: HTMLElement;
  readonly words = new Words((at) => this.chooseAt(at));
  readonly rules = new RuleStrip((rule) => this.showRules(rule));
  /** How it ended, and why. */
  readonly outcome: HTMLElement;
  private robot!: Robot;
  private map = new MapView(() => this.robot, (name) => this.chooseNode(nodeNaming(this.film.nodes.map(valuesOf), name, this.chosen)));
  private speech = new Speech();
  private story = h("ol", { class: "log story", tabindex: 0 });
  private chosen = -1; // the node that somebody selected, -1 for none
  private withRules = false; // the tree has the house rules, too
  private now = 0;
  private shown = 0; // the moment that is shown
  private things = new Map<string, Thing>();
  private rows: ReturnType<Scene["begin"]>;
  private inner: Set<number> | null = null; // nodes that lead others
  private draw = oncePerFrame(() => this.show());

  /** `jump` is told what somebody chose in the story: a time, in seconds, and a node (-1: none); `light` gets
   *  the pieces of the text that run, or are selected. */
  constructor(
    readonly film: Film,
    jump: (seconds: number, node: number) => void,
    private selected: (node: number) => void = () => undefined,
    private light: (marked: Piece[]) => void = () => undefined,
  ) {
    this.rows = this.begin();
    this.tree = new TreeView({ label: t("watch.tree"), select: (node) => { this.chosen = node; this.showWords(); this.selected(node); } });
    const items = film.story.map((each) =>
      h("li", {}, h("time", {}, clock(each[0])), h("button", { type: "button", class: "plain", dir: "auto", onclick: () => jump(each[0], each[1]) }, noted(each))),
    );
    fill(this.story, ...items);
    this.place = h("div", { class: "card place" }, this.map.canvas, this.speech.element);
    this.log = h("div", { class: "card events" }, h("h2", {}, t("log")), this.story);
    this.outcome = h("div", { class: `outcome ${ending(film)}`, tabindex: 0 }, ...inWords(film));
    this.setNodes();
    this.showWords();
  }

  /** Shows the tree with the house rules, at one of them; again without them where it's shown already. */
  private showRules([node]: Rule): void {
    this.withRules = !(this.withRules && this.tree.selected === node);
    this.setNodes();
    if (this.withRules) this.select(node);
  }

  /** Marks the nodes that failed in some of many runs; none with no numbers. */
  markFailed(failures: readonly [node: number, runs: number][], all: number): void {
    for (const node of this.film.nodes) delete node.failed;
    for (const [node, runs] of failures) this.film.nodes[node]!.failed = [runs, all];
    this.setNodes();
    this.select(this.chosen);
  }

  private setNodes(): void {
    const { statuses } = this.tree.shown;
    const nodes = joined(this.film.nodes);
    this.tree.setNodes(this.withRules ? nodes : withoutRules(nodes, this.film.root));
    this.tree.setStatuses(statuses.entries());
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
    this.chosen = node;
    this.tree.select(node);
    this.showWords();
  }

  /** When a node failed last. */
  timeOf(node: number): number {
    const failure = this.film.names.indexOf("FAILURE");
    const found = this.film.statuses.findLast((row) => row.some((each, at) => at % 2 === 1 && each === node && row[at + 1] === failure));
    return found?.[0] ?? this.film.seconds;
  }

  /** At the beginning of the film, where nothing has happened. */
  private begin() {
    const { film } = this;
    this.robot = new Robot("film");
    this.take("map", { ...film.map });
    this.things.clear();
    const events = film.events.map((event): [number, typeof event] => [event.t, event]);
    return {
      statuses: new Rows(film.statuses), words: new Rows(film.words), robot: new Rows(film.robot), things: new Rows(film.things), doing: new Rows(film.doing), events: new Rows(events),
    };
  }

  private show(): void {
    const { film, now } = this;
    if (now < this.shown) {
      this.rows = this.begin();
      this.tree.setStatuses(film.nodes.map((_, index) => [index, STATUSES[0]] as const));
      this.tree.setWords(film.words.map(([, node]) => [node, film.nodes[node]!.label] as const));
    }
    this.shown = now;
    const changes = new Map<number, Status>();
    for (const [, ...row] of this.rows.statuses.upTo(now)) for (let at = 0; at < row.length; at += 2) changes.set(row[at]!, film.names[row[at + 1]!]!);
    this.tree.setStatuses(changes);
    this.rules.show(film.rules, this.tree.shown.statuses);
    this.tree.setWords(new Map([...this.rows.words.upTo(now)].map(([, node, words]) => [node, words])));
    this.tell();
    this.speech.show(this.robot);
    this.map.redraw();
    this.showWords();
    const current = film.story.findLastIndex(([seconds]) => seconds <= now + 1e-6);
    [...this.story.children].forEach((item, index) => item.classList.toggle("now", index === current));
  }

  /** Takes in the messages that the robot sent up to this moment. */
  private tell(): void {
    const { rows, now } = this;
    for (const [, x, y, heading, battery, left, right] of rows.robot.upTo(now)) {
      const pose = x === null || y === null ? null : [x, y, heading ?? 0];
      this.take("robot", { stopped: "", paused: false, hindrance: "", pose, battery, left, right });
    }
    for (const [, ...thing] of rows.things.upTo(now)) this.things.set(thing[0], thing);
    this.take("things", { things: [...this.things.values()] });
    for (const [, task, goal, says, heard] of rows.doing.upTo(now)) this.take("doing", { task, goal, says, heard });
    for (const [, event] of rows.events.upTo(now)) {
      const moved = whole(event);
      if (moved.event !== "door") continue;
      const doors = this.robot.map?.doors?.map((door) => (door.name === moved.name ? { ...door, open: moved.open } : door));
      this.take("map", { ...this.film.map, doors });
    }
  }

  private take(type: string, fields: object): void {
    this.robot.take({ type, robot: "film", ...fields });
  }

  /** Selects what is said at a character. */
  private chooseAt(at: number): void {
    this.chooseNode(nodeAt(this.film.nodes, at));
  }

  private chooseNode(node: number): void {
    if (node < 0) return;
    this.select(node);
    this.selected(node);
  }

  private showWords(): void {
    const { text, nodes } = this.film;
    const { statuses } = this.tree.shown;
    const inner = (this.inner ??= new Set(nodes.map(({ parent }) => parent)));
    const place = (at: number): Place => {
      const { start = null, end = null } = nodes[at] ?? {};
      return start !== null && end !== null ? [start, end] : null;
    };
    const running = nodes.flatMap((_, at) => (statuses[at] === "RUNNING" && !inner.has(at) ? [place(at)] : []));
    const marked = pieces(running, place(this.chosen));
    this.words.show(text, marked);
    this.light(marked);
    this.map.mark(nodes[this.chosen] ? valuesOf(nodes[this.chosen]!) : []);
  }
}
