// A film of a run, of a recording or of a trial, from any moment on.
import { h } from "../dom";
import { t } from "../texts";
import type { Piece } from "../watch/words";
import { Plots, seriesOf } from "./plots";
import { Scene, type Film } from "./scene";
import { Timeline } from "./timeline";

export type { Film } from "./scene";

export class Player {
  readonly element: HTMLElement;
  readonly scene: Scene;
  private timeline: Timeline;

  /** `moved` is told the time, in seconds, when somebody chose it; `light` the pieces of the text that run or are
   *  selected, where the text is beside the player.
   */
  constructor(
    film: Film,
    at = 0,
    private moved: (seconds: number) => void = () => undefined,
    light?: (marked: Piece[]) => void,
  ) {
    const scene = new Scene(film, (seconds, node) => this.jump(seconds, node), undefined, light);
    const failure = film.failed >= 0 && h("button", { type: "button", onclick: () => this.jump(scene.timeOf(film.failed), film.failed) }, t("film.failure"));
    const plots = new Plots((seconds) => this.jump(seconds, -1));
    plots.draw(seriesOf(film), film.seconds);
    const seek = (): void => {
      scene.seek(this.timeline.now);
      plots.show(this.timeline.now);
    };
    this.scene = scene;
    this.timeline = new Timeline(film.seconds, seek, moved, failure);
    this.timeline.element.prepend(plots.element);
    const text = film.text && !light && h("div", { class: "card text-card" }, scene.words.element);
    this.element = h(
      "section",
      { class: "film" },
      scene.outcome,
      scene.rules.element,
      h("div", { class: "panes" }, h("div", { class: "script" }, text, scene.log), h("div", { class: "stage card" }, scene.tree.element), h("div", { class: "side", tabindex: 0 }, scene.place)),
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
  }
}
