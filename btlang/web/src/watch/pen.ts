// What a map is drawn with: shapes at places of the world, in metres, with sizes in pixels.
import type { Point } from "../fleet";
import { Labels } from "./labels";

const HATCH = 8; // pixels between the lines of a closed zone

export class Pen {
  readonly labels = new Labels();

  /** `left` and `bottom` are where the origin of the world is, in pixels; `colour` gives a colour of the page. */
  constructor(
    readonly context: CanvasRenderingContext2D,
    readonly scale: number,
    private left: number,
    private bottom: number,
    readonly colour: (name: string) => string,
  ) {
    context.lineJoin = context.lineCap = "round";
  }

  at([x, y]: Point): Point {
    return [this.left + x * this.scale, this.bottom - y * this.scale];
  }

  line(points: Point[], stroke: string, thick: number, dashes: number[] = []): void {
    this.trace(points);
    this.stroke(stroke, thick, dashes);
  }

  disc(point: Point, radius: number, paint: string): void {
    this.round(point, radius);
    this.context.fillStyle = paint;
    this.context.fill();
  }

  /** A disc, or only its edge. */
  mark(point: Point, radius: number, paint: string, isFilled: boolean): void {
    if (isFilled) return this.disc(point, radius, paint);
    this.disc(point, radius, this.colour("surface"));
    this.round(point, radius - 1);
    this.stroke(paint, 2, []);
  }

  area(points: Point[], paint: string, isHatched: boolean, dashes: number[] = []): void {
    const { context } = this;
    this.trace(points);
    context.closePath();
    context.globalAlpha = 0.18;
    context.fillStyle = paint;
    context.fill();
    context.globalAlpha = 1;
    this.stroke(paint, 1.5, dashes);
    if (isHatched) this.hatch(points, paint);
  }

  /** A name beside what reaches `gap` pixels from a point; it's written with the others by `names`. */
  name(text: string, point: Point, paint: string, gap: number): void {
    this.labels.add(text, this.at(point), paint, gap);
  }

  /** Writes all names, above what has been drawn. */
  names(): void {
    this.labels.write(this.context, this.colour("surface"));
  }

  private trace(points: Point[]): void {
    this.context.beginPath();
    points.forEach((point, index) => (index ? this.context.lineTo(...this.at(point)) : this.context.moveTo(...this.at(point))));
  }

  private round(point: Point, radius: number): void {
    this.context.beginPath();
    this.context.arc(...this.at(point), radius, 0, 2 * Math.PI);
  }

  private stroke(stroke: string, thick: number, dashes: number[]): void {
    this.context.strokeStyle = stroke;
    this.context.lineWidth = thick;
    this.context.setLineDash(dashes);
    this.context.stroke();
  }

  private hatch(points: Point[], paint: string): void {
    const { context } = this;
    const corners = points.map((point) => this.at(point));
    const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    context.save();
    this.trace(points);
    context.clip();
    context.beginPath();
    for (let along = left - (bottom - top); along < right; along += HATCH) {
      context.moveTo(along, bottom);
      context.lineTo(along + bottom - top, top);
    }
    context.globalAlpha = 0.6;
    this.stroke(paint, 1, []);
    context.restore();
  }
}
