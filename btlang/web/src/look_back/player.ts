// A film of a run, of a recording or of a trial, from any moment on.
import { h } from "../dom";
import { t } from "../texts";
import { Scene, type Film } from "./scene";
import { Timeline } from "./timeline";

export type { Film } from "./scene";

export class Player {
  readonly element: HTMLElement;
  readonly scene: Scene;
  private timeline: Timeline;
  private selected: (node: number) => void;

  /** `moved` is told the time, in seconds, when somebody chose it; `said` the characters that say a chosen node, where the
   *  text stands beside it.
   */
  constructor(
    film: Film,
    at = 0,
    private moved: (seconds: number) => void = () => undefined,
    said?: (start: number, end: number) => void,
  ) {
    this.selected = (node) => {
      const { start = null, end = null } = film.nodes[node] ?? {};
      if (said && start !== null && end !== null) said(start, end);
    };
    const scene = new Scene(film, (seconds, node) => this.jump(seconds, node), this.selected);
    const failure = film.failed >= 0 && h("button", { type: "button", onclick: () => this.jump(scene.timeOf(film.failed), film.failed) }, t("film.failure"));
    this.scene = scene;
    this.timeline = new Timeline(film.seconds, () => scene.seek(this.timeline.now), moved, failure);
    this.element = h(
      "section",
      { class: "film" },
      scene.outcome,
      scene.rules.element,
      h("div", { class: "panes" }, h("div", { class: "stage card" }, scene.tree.element), h("div", { class: "side" }, scene.place, scene.log, film.text && !said && h("div", { class: "card" }, scene.words.element))),
      this.timeline.element,
    );
    this.timeline.seek(at || (film.failed >= 0 ? scene.timeOf(film.failed) : 0));
    scene.select(film.failed);
  }

  /** In seconds. */
  get now(): number {
    return this.timeline.now;
  }

  close(): void {
    this.timeline.close();
    this.scene.close();
  }

  private jump(seconds: number, node: number): void {
    this.timeline.seek(seconds);
    this.moved(seconds);
    this.scene.select(node);
    this.selected(node);
  }
}
