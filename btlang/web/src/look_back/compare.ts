// Two runs side by side, at one moment: where they differ first, what ended otherwise, and what only one of them did.
import { h } from "../dom";
import { ANSWERS, type Status } from "../fleet";
import { moment, said, t } from "../texts";
import { called } from "../tasks/queue";
import { noted, Scene, type Film, type Noted } from "./scene";
import { clock, Timeline } from "./timeline";

/** See btlang/recording/film.py. */
export interface Compared {
  films: [Film, Film];
  stories: [which: number, ...Noted][];
  missions: string[];
  first: [Step, Step] | null;
  ended: number[];
}

interface Step {
  t: number | null;
  node: number;
  status: Status;
  reason: string;
}

const NAMES = ["A", "B"];
const APART = 0.05; // seconds between two first differences that are worth to be put side by side
const MOST = 12; // nodes that are listed

export class Comparison {
  readonly element: HTMLElement;
  private scenes: [Scene, Scene];
  private timeline: Timeline;
  private shift = 0; // seconds that the second run is ahead

  /** `moved` is told the time, in seconds of the first run, when somebody chose it. */
  constructor(
    private compared: Compared,
    at: number | null,
    private moved: (seconds: number) => void,
  ) {
    const { films, first, ended } = compared;
    for (const film of films) for (const node of ended) film.nodes[node]!.differs = true;
    const same = !compared.missions.length;
    const scene = (which: 0 | 1): Scene =>
      new Scene(films[which], (seconds, node) => this.jump(seconds - (which ? this.shift : 0), node), (node) => same && this.scenes[1 - which]!.select(node));
    this.scenes = [scene(0), scene(1)];
    this.timeline = new Timeline(this.seconds, () => this.show(), moved, this.alignment());
    this.element = h("section", { class: "film compared" }, this.summary(), h("div", { class: "sides" }, ...this.scenes.map((each, which) => this.side(each, which))), this.timeline.element);
    this.timeline.seek(at ?? first?.[0].t ?? 0);
    if (at === null && first) this.select(first[0].node);
  }

  close(): void {
    this.timeline.close();
    for (const scene of this.scenes) scene.close();
  }

  private get seconds(): number {
    const [one, other] = this.compared.films;
    return Math.max(one.seconds, other.seconds - this.shift);
  }

  private show(): void {
    this.scenes[0].seek(this.timeline.now);
    this.scenes[1].seek(this.timeline.now + this.shift);
  }

  private select(node: number): void {
    for (const scene of this.scenes) if (!this.compared.missions.length) scene.select(node);
  }

  private jump(seconds: number, node: number): void {
    this.timeline.seek(seconds);
    this.moved(this.timeline.now);
    this.select(node);
  }

  private side(scene: Scene, which: number): HTMLElement {
    const { about } = scene.film;
    const title = h("h2", { class: "what" }, badge(which), h("span", { dir: "auto" }, titleOf(scene.film)), h("time", {}, about["wall"] ? moment(Number(about["wall"])) : ""));
    return h("section", { class: "one", "aria-label": NAMES[which] }, title, h("div", { class: "ending" }, scene.outcome, scene.rules.element), h("div", { class: "said-in" }, scene.film.text && h("div", { class: "card text-card" }, scene.words.element)), h("div", { class: "stage card" }, scene.tree.element), h("div", { class: "below" }, scene.log, scene.place));
  }

  private summary(): HTMLElement {
    const { missions, first, stories, ended, films } = this.compared;
    const lines = (key: "compare.missions" | "compare.stories", found: HTMLElement[]): HTMLElement | false =>
      found.length > 0 && h("details", {}, h("summary", {}, t(key, { count: found.length })), h("ul", { class: "only" }, ...found));
    const steps = first?.map((step, which) => side(which, stepInWords(films[which]!, step)));
    const parents = new Set(films[0].nodes.map(({ parent }) => parent));
    const leaves = ended.filter((node) => !parents.has(node)); // those above follow from them
    const nodes = leaves.slice(0, MOST).map((node) => h("button", { type: "button", dir: "auto", onclick: () => this.jump(this.lastOf(node), node) }, films[0].nodes[node]!.label));
    return h(
      "div",
      { class: "card summary" },
      missions.length > 0 && h("p", {}, t("compare.other_missions")),
      !missions.length && !first && h("p", {}, t("compare.same")),
      steps && h("div", { class: "first" }, h("h2", {}, t("compare.first")), h("ul", {}, ...steps), h("button", { type: "button", class: "primary", onclick: () => this.toFirst() }, t("compare.go"))),
      nodes.length > 0 && h("div", { class: "ended" }, h("h2", {}, t("compare.ended", { count: leaves.length })), h("div", { class: "controls" }, ...nodes)),
      lines("compare.missions", missions.map(difference)),
      lines("compare.stories", stories.map(([which, ...each]) => side(which, `${clock(each[0])}  ${noted(each)}`))),
    );
  }

  private toFirst(): void {
    const [one, other] = this.compared.first!;
    this.jump(one.t ?? (other.t ?? 0) - this.shift, one.node >= 0 ? one.node : other.node);
  }

  /** When a node had its last status, in seconds of the first run. */
  private lastOf(node: number): number {
    const last = (film: Film): number | undefined => film.statuses.findLast((row) => row.some((each, at) => at % 2 === 1 && each === node))?.[0];
    const [one, other] = this.compared.films;
    return last(one) ?? (last(other) ?? 0) - this.shift;
  }

  /** Where the first difference came at another time: whether both are shown there, or since the beginning. */
  private alignment(): HTMLElement | false {
    const { first } = this.compared;
    const apart = first && first[0].t !== null && first[1].t !== null ? first[1].t - first[0].t : 0;
    if (Math.abs(apart) < APART) return false;
    const box = h("input", { type: "checkbox" });
    box.addEventListener("change", () => {
      this.shift = box.checked ? apart : 0;
      this.timeline.lengthen(this.seconds);
      this.toFirst();
    });
    return h("label", { class: "check" }, box, t("compare.align"));
  }
}

const badge = (which: number): HTMLElement => h("b", { class: `badge side${which}` }, NAMES[which]);

/** A line of `btc diff`: what only the first one has begins with a minus, what only the second one has with a plus. */
function difference(line: string): HTMLElement {
  const which = ["- ", "+ "].indexOf(line.slice(0, 2));
  return which < 0 ? h("li", { lang: "en", dir: "auto" }, line) : side(which, line.slice(2));
}

const side = (which: number, words: string): HTMLElement => h("li", {}, badge(which), h("span", { dir: "auto" }, words));

/** A change of status; null is the time of a run that has no more. */
function stepInWords({ nodes }: Film, { t: seconds, node, status, reason }: Step): string {
  if (seconds === null) return t("compare.no_more");
  const { label, asks } = nodes[node]!;
  return `${clock(seconds)}  ${t(`log.${(asks && ANSWERS[status]) || status}`, { name: label })}${reason && ` (${said(reason)})`}`;
}

/** The first line of a mission that says something, or its name. */
export function titleOf({ text, about }: Film): string {
  return called({ mission: text.split("\n").find((line) => line.trim()) ?? about["mission"] ?? "" }).trim() || t("runs.unnamed");
}
