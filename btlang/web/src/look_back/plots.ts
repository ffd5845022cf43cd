// Values of a run over its time: the battery, what is nearest to the robot, and what the mission counts.
import { fill, h, s, set } from "../dom";
import { t } from "../texts";

const WIDE = 1000;
const HIGH = 28;
const MOST = 6; // values that are drawn

/** A value over time: seconds and number, in the order of time. */
export interface Series {
  name: string;
  points: [t: number, value: number][];
}

/** What can be drawn of a film: values that change. */
export function seriesOf(film: {
  robot: [t: number, x: number | null, y: number | null, heading: number | null, battery: number | null, ...unknown[]][];
  scans: [t: number, ranges: (number | null)[]][];
  values: [t: number, name: string, value: number][];
}): Series[] {
  const named = new Map<string, Series["points"]>();
  const add = (name: string, seconds: number, value: number | null): void => {
    if (value === null) return;
    const points = named.get(name) ?? [];
    if (points.at(-1)?.[1] !== value) points.push([seconds, value]);
    named.set(name, points);
  };
  for (const [seconds, , , , battery] of film.robot) add(t("plots.battery"), seconds, battery === null ? null : Math.round(battery * 10) / 10);
  for (const [seconds, ranges] of film.scans) {
    const seen = ranges.filter((range) => range !== null);
    add(t("plots.nearest"), seconds, seen.length ? Math.min(...seen) : null);
  }
  for (const [seconds, name, value] of film.values) add(name.replace(/_/g, " "), seconds, value);
  return [...named].map(([name, points]) => ({ name, points })).filter(({ points }) => points.length > 1).slice(0, MOST);
}

/** The value at a moment, null before the first one. */
export function valueAt({ points }: Series, now: number): number | null {
  return points.findLast(([seconds]) => seconds <= now + 1e-6)?.[1] ?? null;
}

export class Plots {
  readonly element: HTMLElement;
  private rows: { series: Series; cursor: SVGLineElement; value: HTMLElement }[];

  /** `choose` gets the seconds that somebody points at. */
  constructor(
    series: Series[],
    private seconds: number,
    private choose: (seconds: number) => void,
  ) {
    this.rows = series.map((each) => ({ series: each, cursor: s("line", { y1: 0, y2: HIGH, class: "cursor" }), value: h("output", {}) }));
    this.element = h("ul", { class: "plots", hidden: !series.length, "aria-label": t("plots") }, ...this.rows.map((row) => this.row(row)));
  }

  /** Shows a moment, in seconds. */
  show(now: number): void {
    const x = this.seconds ? (now / this.seconds) * WIDE : 0;
    for (const { series, cursor, value } of this.rows) {
      set(cursor, { x1: x, x2: x });
      const found = valueAt(series, now);
      fill(value, found === null ? "" : String(found));
    }
  }

  private row({ series, cursor, value }: { series: Series; cursor: SVGLineElement; value: HTMLElement }): HTMLElement {
    const values = series.points.map(([, each]) => each);
    const [least, most] = [Math.min(...values), Math.max(...values)];
    const x = (seconds: number): string => ((seconds / this.seconds) * WIDE).toFixed(1);
    const y = (each: number): string => (HIGH - 3 - ((each - least) / (most - least || 1)) * (HIGH - 6)).toFixed(1);
    const path = series.points.map(([seconds, each], index) => (index ? `H${x(seconds)}V${y(each)}` : `M${x(seconds)} ${y(each)}`)).join("");
    const picture = s("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, preserveAspectRatio: "none", role: "img", "aria-label": t("plots.range", { name: series.name, least, most }) }, s("path", { d: `${path}H${WIDE}` }), cursor);
    picture.addEventListener("click", (event) => {
      const { left, width } = picture.getBoundingClientRect();
      this.choose(((event.clientX - left) / width) * this.seconds);
    });
    return h("li", {}, h("span", { dir: "auto" }, series.name), picture, value);
  }
}
