// The robot on its map, on a canvas: walls, boxes, places, people, objects, its way, and what its scanner sees.
import { h, oncePerFrame } from "../dom";
import type { Point, Robot } from "../fleet";
import { t } from "../texts";

const EDGE = 0.6; // metres around what is drawn
const ROBOT = 0.28; // metres: robots don't say how large they are

interface Bounds {
  left: number;
  right: number;
  bottom: number;
  top: number;
}

export class MapView {
  readonly canvas = h("canvas", { class: "map", role: "img", "aria-label": t("map") });
  /** Draws it before the next picture. */
  readonly redraw = oncePerFrame(() => this.draw());
  private resized = new ResizeObserver(() => this.redraw());

  constructor(private robot: () => Robot) {
    this.resized.observe(this.canvas);
    addEventListener("themechange", this.redraw);
  }

  close(): void {
    this.resized.disconnect();
    removeEventListener("themechange", this.redraw);
  }

  private draw(): void {
    const { canvas } = this;
    const pen = canvas.getContext("2d");
    const robot = this.robot();
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!pen || !width || !height) return;
    const ratio = devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const style = getComputedStyle(canvas);
    const colour = (name: string): string => style.getPropertyValue(`--${name}`).trim();
    const bounds = boundsOf(robot);
    const scale = Math.min(width / (bounds.right - bounds.left), height / (bounds.top - bounds.bottom));
    const left = (width - scale * (bounds.left + bounds.right)) / 2;
    const bottom = (height + scale * (bounds.bottom + bounds.top)) / 2;
    const at = ([x, y]: Point): Point => [left + x * scale, bottom - y * scale];
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = pen.lineCap = "round";
    const line = (points: Point[], stroke: string, thick: number, dashes: number[] = []): void => {
      pen.beginPath();
      points.forEach((point, index) => (index ? pen.lineTo(...at(point)) : pen.moveTo(...at(point))));
      pen.strokeStyle = stroke;
      pen.lineWidth = thick;
      pen.setLineDash(dashes);
      pen.stroke();
    };
    const disc = ([x, y]: Point, radius: number, paint: string): void => {
      pen.beginPath();
      pen.arc(...at([x, y]), radius, 0, 2 * Math.PI);
      pen.fillStyle = paint;
      pen.fill();
    };
    const write = (text: string, [x, y]: Point, paint: string, above: number): void => {
      const [px, py] = at([x, y]);
      pen.font = "12px system-ui, sans-serif";
      pen.textAlign = "center";
      pen.lineWidth = 3;
      pen.setLineDash([]);
      pen.strokeStyle = colour("surface");
      pen.strokeText(text, px, py - above);
      pen.fillStyle = paint;
      pen.fillText(text, px, py - above);
    };
    const { map, scan, path, way } = robot;
    const pose = robot.state?.pose ?? null;
    for (const box of map?.boxes ?? []) {
      const [x, y] = at([box.x - box.width / 2, box.y + box.height / 2]);
      pen.fillStyle = colour("box");
      pen.fillRect(x, y, box.width * scale, box.height * scale);
    }
    for (const wall of map?.walls ?? []) line(wall, colour("wall"), 2.5);
    for (const [index, range] of scan?.ranges.entries() ?? []) {
      if (range === null || !scan) continue;
      const [x, y, heading] = scan.pose;
      const angle = (heading * Math.PI) / 180 + (2 * Math.PI * index) / scan.ranges.length;
      disc([x + range * Math.cos(angle), y + range * Math.sin(angle)], 1.2, colour("scan"));
    }
    const goal = map?.places.find((place) => place.name === robot.goal) ?? map?.people.find((person) => person.name === robot.goal) ?? map?.objects.find((object) => object.name === robot.goal);
    for (const place of map?.places ?? []) {
      line([[place.x - 0.1, place.y], [place.x + 0.1, place.y]], colour("muted"), 1.5);
      line([[place.x, place.y - 0.1], [place.x, place.y + 0.1]], colour("muted"), 1.5);
      write(place.name, [place.x, place.y], colour("muted"), 8);
    }
    for (const object of map?.objects ?? []) {
      disc([object.x, object.y], Math.max(3, object.radius * scale), colour("object"));
      write(object.name, [object.x, object.y], colour("muted"), 8);
    }
    for (const person of map?.people ?? []) {
      disc([person.x, person.y], Math.max(4, person.radius * scale), colour("person"));
      write(person.name, [person.x, person.y], colour("text"), person.radius * scale + 5);
    }
    line(path, colour("running"), 2);
    if (!pose) return;
    const here: Point = [pose[0], pose[1]];
    if (way.length) line(way, colour("running"), 1.5, [4, 5]);
    else if (goal) line([here, [goal.x, goal.y]], colour("running"), 1.5, [4, 5]);
    const size = Math.max(7, ROBOT * scale);
    disc(here, size + 2, colour("surface"));
    disc(here, size, colour("running"));
    const [x, y] = at(here);
    const heading = (-pose[2] * Math.PI) / 180;
    pen.beginPath();
    pen.moveTo(x + size * 0.75 * Math.cos(heading), y + size * 0.75 * Math.sin(heading));
    for (const side of [2.4, -2.4]) pen.lineTo(x + size * 0.6 * Math.cos(heading + side), y + size * 0.6 * Math.sin(heading + side));
    pen.closePath();
    pen.fillStyle = colour("surface");
    pen.fill();
  }
}

/** What is to be seen, in metres. */
function boundsOf({ map, path, state }: Robot): Bounds {
  const points: Point[] = [...(map?.walls.flat() ?? []), ...path];
  for (const box of map?.boxes ?? []) points.push([box.x - box.width / 2, box.y - box.height / 2], [box.x + box.width / 2, box.y + box.height / 2]);
  for (const each of [...(map?.places ?? []), ...(map?.people ?? []), ...(map?.objects ?? [])]) points.push([each.x, each.y]);
  if (state?.pose) points.push([state.pose[0], state.pose[1]]);
  const found: Bounds = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  for (const [x, y] of points) {
    found.left = Math.min(found.left, x);
    found.right = Math.max(found.right, x);
    found.bottom = Math.min(found.bottom, y);
    found.top = Math.max(found.top, y);
  }
  if (!points.length) return { left: -3, right: 3, bottom: -3, top: 3 };
  const wider = Math.max(0, 2 - (found.right - found.left)) / 2 + EDGE;
  const higher = Math.max(0, 2 - (found.top - found.bottom)) / 2 + EDGE;
  return { left: found.left - wider, right: found.right + wider, bottom: found.bottom - higher, top: found.top + higher };
}
