// The moment of a run that is shown: a slider, and playing on from there.
import { fill, h, set } from "../dom";
import { t } from "../texts";

const SPEEDS = [1, 4, 20];

export class Timeline {
  readonly element: HTMLElement;
  /** In seconds. */
  now = 0;
  private slider = h("input", { type: "range", min: 0, step: "any", "aria-label": t("film.time") });
  private clock = h("output", { class: "clock" });
  private button = h("button", { type: "button", class: "primary", onclick: () => this.toggle() }, t("film.play"));
  private speed = h("select", { "aria-label": t("film.speed") }, ...SPEEDS.map((each) => h("option", { value: each }, `${each}×`)));
  private playing = false;
  private last = 0;
  private closed = false;

  /** `show` is told each moment, `moved` one that somebody chose. */
  constructor(
    private seconds: number,
    private show: () => void,
    private moved: (seconds: number) => void,
    ...more: (HTMLElement | false)[]
  ) {
    set(this.slider, { max: seconds });
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.slider.addEventListener("change", () => moved(this.now));
    this.element = h("div", { class: "timeline card" }, this.button, this.slider, h("div", { class: "controls" }, this.clock, this.speed, ...more));
  }

  close(): void {
    this.closed = true;
  }

  /** Another length, in seconds. */
  lengthen(seconds: number): void {
    this.seconds = seconds;
    set(this.slider, { max: seconds });
  }

  seek(seconds: number): void {
    this.now = Math.min(Math.max(seconds, 0), this.seconds);
    this.slider.value = String(this.now);
    set(this.slider, { "aria-valuetext": clock(this.now) });
    fill(this.clock, `${clock(this.now)} / ${clock(this.seconds)}`);
    this.show();
  }

  private toggle(): void {
    this.playing = !this.playing;
    fill(this.button, t(this.playing ? "film.pause" : "film.play"));
    if (!this.playing) return this.moved(this.now);
    if (this.now >= this.seconds) this.now = 0;
    this.last = performance.now();
    requestAnimationFrame(() => this.step());
  }

  private step(): void {
    if (!this.playing || this.closed) return;
    const time = performance.now();
    this.seek(this.now + ((time - this.last) / 1000) * Number(this.speed.value));
    this.last = time;
    if (this.now >= this.seconds) this.toggle();
    else requestAnimationFrame(() => this.step());
  }
}

/** Minutes and seconds. */
export function clock(seconds: number): string {
  return `${Math.floor(seconds / 60)}:${(seconds % 60).toFixed(1).padStart(4, "0")}`;
}
