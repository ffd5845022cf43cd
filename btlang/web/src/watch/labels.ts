// The names on a map, each where no other name is: beside what it names, or with a line to it. One without a place isn't written.
import type { Point } from "../fleet";

const FONT = "12px system-ui, sans-serif";
const HEIGHT = 14; // pixels of a line of it

interface Label {
  text: string;
  at: Point;
  paint: string;
  gap: number;
}

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

export class Labels {
  private labels: Label[] = [];
  private taken: Box[] = [];

  /** A name for what is at a point and reaches `gap` pixels from it; the first ones added choose their places first. */
  add(text: string, at: Point, paint: string, gap: number): void {
    this.labels.push({ text, at, paint, gap });
  }

  /** No name is written over what is at a point and reaches `radius` pixels from it, unless there is no other place. */
  keepFree([x, y]: Point, radius: number): void {
    this.taken.push({ left: x - radius, right: x + radius, top: y - radius, bottom: y + radius });
  }

  /** Writes them, with an edge that sets them off from what is below. */
  write(context: CanvasRenderingContext2D, edge: string): void {
    const { clientWidth: wide, clientHeight: high } = context.canvas;
    context.font = FONT;
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.setLineDash([]);
    const names: Box[] = [];
    const written: [Label, Box][] = [];
    for (const label of this.labels) {
      const { text, at, gap } = label;
      const places = placesOf(at, context.measureText(text).width, gap, wide, high).filter((place) => names.every((box) => !shared(place, box)));
      const box = freest(places, this.taken);
      if (!box) continue;
      names.push(box);
      this.taken.push(box);
      written.push([label, box]);
    }
    for (const each of written) lead(context, ...each); // below all names
    context.lineWidth = 3;
    context.strokeStyle = edge;
    for (const [{ text, paint }, box] of written) {
      const middle = (box.top + box.bottom) / 2;
      context.strokeText(text, box.left, middle);
      context.fillStyle = paint;
      context.fillText(text, box.left, middle);
    }
  }
}

/** Draws a line from what is named to a name that isn't beside it. */
function lead(context: CanvasRenderingContext2D, { at: [x, y], paint, gap }: Label, { left, right, top, bottom }: Box): void {
  const [across, down] = [Math.max(left, Math.min(x, right)), Math.max(top, Math.min(y, bottom))];
  if (Math.hypot(across - x, down - y) < gap + 1.5 * HEIGHT) return;
  context.lineWidth = 1;
  context.strokeStyle = paint;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(across, down);
  context.stroke();
}

/** Above, below, right and left of a point, then further away above and below; moved into a picture of a size. */
function placesOf([x, y]: Point, width: number, gap: number, wide: number, high: number): Box[] {
  const box = (across: number, down: number): Box => {
    const [left, top] = [Math.max(0, Math.min(across, wide - width)), Math.max(0, Math.min(down - HEIGHT / 2, high - HEIGHT))];
    return { left, right: left + width, top, bottom: top + HEIGHT };
  };
  const rows = [0, 1, 2, 3].flatMap((row) => [-1, 1].map((side) => box(x - width / 2, y + side * (gap + HEIGHT * (row + 0.5)))));
  const aside = [-1, 1, -2, 2].flatMap((row) => [box(x + gap, y + row * HEIGHT), box(x - gap - width, y + row * HEIGHT)]);
  return [...rows.slice(0, 2), box(x + gap, y), box(x - gap - width, y), ...rows.slice(2), ...aside];
}

/** The first place that is free, or the one with the least of what should be seen in it. */
function freest(places: Box[], taken: Box[]): Box | undefined {
  const covered = places.map((place) => taken.reduce((sum, box) => sum + shared(place, box), 0));
  return places[covered.indexOf(Math.min(...covered))];
}

/** Square pixels that two boxes have in common. */
function shared(one: Box, other: Box): number {
  const across = Math.min(one.right, other.right) - Math.max(one.left, other.left);
  const up = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
  return Math.max(0, across) * Math.max(0, up);
}
