// Values over the time of a run: the battery, what is nearest to the robot, and what the mission counts.
import { fill, h, s, set } from "../dom";
import { t } from "../texts";

const WIDE = 1000;
const HIGH = 28;
const MOST = 6; // values that are drawn
const MOST_POINTS = 4000; // of each

/** A value over time: seconds and number, in the order of time. */
export interface Series {
  name: string;
  points: [t: number, value: number][];
}

/** Values as they come, each in the order of time. */
export class Values {
  private named = new Map<string, Series["points"]>();

  battery(seconds: number, percent: number | null): void {
    this.add(t("plots.battery"), seconds, percent === null ? null : Math.round(percent * 10) / 10);
  }

  /** What a scanner saw, in metres. */
  scan(seconds: number, ranges: (number | null)[]): void {
    const seen = ranges.filter((range) => range !== null);
    this.add(t("plots.nearest"), seconds, seen.length ? Math.min(...seen) : null);
  }

  /** What the mission counts, by its name there. */
  count(seconds: number, name: string, value: number): void {
    this.add(name.replace(/_/g, " "), seconds, value);
  }

  /** Those that change. */
  get series(): Series[] {
    return [...this.named].map(([name, points]) => ({ name, points })).filter(({ points }) => points.length > 1).slice(0, MOST);
  }

  private add(name: string, seconds: number, value: number | null): void {
    const points = this.named.get(name) ?? [];
    if (value === null || points.at(-1)?.[1] === value) return;
    points.push([seconds, value]);
    this.named.set(name, points.length > MOST_POINTS ? points.filter((_, index) => index % 2 === 0) : points);
  }
}

/** What can be drawn of a film: values that change. */
export function seriesOf(film: {
  robot: [t: number, x: number | null, y: number | null, heading: number | null, battery: number | null, ...unknown[]][];
  scans: [t: number, ranges: (number | null)[]][];
  values: [t: number, name: string, value: number][];
}): Series[] {
  const values = new Values();
  for (const [seconds, , , , battery] of film.robot) values.battery(seconds, battery);
  for (const [seconds, ranges] of film.scans) values.scan(seconds, ranges);
  for (const [seconds, name, value] of film.values) values.count(seconds, name, value);
  return values.series;
}

/** The value at a moment, null before the first one. */
export function valueAt({ points }: Series, now: number): number | null {
  return points.findLast(([seconds]) => seconds <= now + 1e-6)?.[1] ?? null;
}

export class Plots {
  readonly element = h("ul", { class: "plots", hidden: true, "aria-label": t("plots") });
  private rows: Row[] = [];
  private seconds = 0;

  /** `choose` gets the seconds that somebody points at. */
  constructor(private choose?: (seconds: number) => void) {}

  /** Draws values over so many seconds; they are known up to `known`. */
  draw(series: Series[], seconds: number, known = seconds): void {
    this.seconds = seconds;
    this.element.hidden = !series.length;
    if (series.map(({ name }) => name).join("\n") !== this.rows.map(({ series }) => series.name).join("\n")) {
      this.rows = series.map((each) => new Row(each, (part) => this.choose?.(part * this.seconds)));
      fill(this.element, ...this.rows.map(({ element }) => element));
    }
    series.forEach((each, index) => this.rows[index]!.draw(each, seconds, known));
  }

  /** Shows a moment, in seconds. */
  show(now: number): void {
    for (const row of this.rows) row.show(now, this.seconds);
  }
}

/** One value: its name, its curve, and how much it is at the moment that is shown. */
class Row {
  readonly element: HTMLElement;
  private curve = s("path");
  private cursor = s("line", { y1: 0, y2: HIGH, class: "cursor" });
  private value = h("output", {});
  private picture = s("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, preserveAspectRatio: "none", role: "img" }, this.curve, this.cursor);

  /** `choose` gets a part of the whole time. */
  constructor(
    public series: Series,
    choose: (part: number) => void,
  ) {
    this.picture.addEventListener("click", (event) => {
      const { left, width } = this.picture.getBoundingClientRect();
      choose((event.clientX - left) / width);
    });
    this.element = h("li", {}, h("span", { dir: "auto" }, series.name), this.picture, this.value);
  }

  draw(series: Series, all: number, known: number): void {
    this.series = series;
    const values = series.points.map(([, each]) => each);
    const [least, most] = [Math.min(...values), Math.max(...values)];
    const x = (seconds: number): string => ((seconds / (all || 1)) * WIDE).toFixed(1);
    const y = (each: number): string => (HIGH - 3 - ((each - least) / (most - least || 1)) * (HIGH - 6)).toFixed(1);
    const path = series.points.map(([seconds, each], index) => (index ? `H${x(seconds)}V${y(each)}` : `M${x(seconds)} ${y(each)}`)).join("");
    set(this.curve, { d: `${path}H${x(known)}` });
    set(this.picture, { "aria-label": t("plots.range", { name: series.name, least, most }) });
  }

  show(now: number, all: number): void {
    const x = all ? (now / all) * WIDE : 0;
    set(this.cursor, { x1: x, x2: x });
    const found = valueAt(this.series, now);
    fill(this.value, found === null ? "" : String(found));
  }
}
