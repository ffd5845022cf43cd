// The robot on its map, on a canvas: walls, zones, places, people, objects, its way, and what its scanner sees.
import { h, oncePerFrame, set } from "../dom";
import type { Point, Robot } from "../fleet";
import { t } from "../texts";
import { Pen } from "./pen";
import { drawDoors, drawLanes, drawRoutes, drawZones, nameDoors, nameZones, objectsOf, peopleOf, zonesOf } from "./surroundings";

const EDGE = 0.6; // metres around what is drawn
const ROBOT = 0.28; // metres: robots don't say how large they are
const HALO = 13; // pixels around what is marked
const NEAR = 24; // pixels between a click and what is meant by it

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
  private marked: readonly string[] = [];
  private pen: Pen | null = null;

  /** `choose` gets the name of the place, person or object that somebody clicks on, "" for none. */
  constructor(
    private robot: () => Robot,
    choose?: (name: string) => void,
  ) {
    this.resized.observe(this.canvas);
    if (choose) this.canvas.addEventListener("click", ({ offsetX, offsetY }) => choose(this.at(offsetX, offsetY)));
    addEventListener("themechange", this.redraw);
  }

  close(): void {
    this.resized.disconnect();
    removeEventListener("themechange", this.redraw);
  }

  /** Marks what has one of these names. */
  mark(names: readonly string[]): void {
    this.marked = names.filter((each) => namedOn(this.robot()).some(({ name }) => name === each));
    set(this.canvas, { "aria-label": [t("map"), ...this.marked].join(": ") });
    this.redraw();
  }

  /** What is nearest to a pixel, "" for nothing. */
  private at(left: number, top: number): string {
    let [nearest, distance] = ["", NEAR];
    for (const { name, x, y } of namedOn(this.robot())) {
      const [across, down] = this.pen?.at([x, y]) ?? [0, 0];
      const far = Math.hypot(across - left, down - top);
      if (far < distance) [nearest, distance] = [name, far];
    }
    return nearest;
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
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.pen = new Pen(pen, scale, left, bottom, colour);
    drawMap(this.pen, robot, this.marked);
  }
}

/** What has a name and is at a point. */
const namedOn = (robot: Robot): { name: string; x: number; y: number }[] => [...(robot.map?.places ?? []), ...peopleOf(robot), ...objectsOf(robot)];

/** The next node behind one whose values name something, -1 for none; `values` are those of each node. */
export function nodeNaming(values: readonly (readonly string[])[], name: string, behind: number): number {
  const next = values.findIndex((each, node) => node > behind && each.includes(name));
  return next < 0 ? values.findIndex((each) => each.includes(name)) : next;
}

function drawMap(pen: Pen, robot: Robot, marked: readonly string[]): void {
  const { context, colour, scale } = pen;
  const { map, scan, path } = robot;
  const pose = robot.state?.pose ?? null;
  const [people, objects, zones] = [peopleOf(robot), objectsOf(robot), zonesOf(robot)];
  drawZones(pen, zones);
  for (const box of map?.boxes ?? []) {
    const [x, y] = pen.at([box.x - box.width / 2, box.y + box.height / 2]);
    context.fillStyle = colour("box");
    context.fillRect(x, y, box.width * scale, box.height * scale);
  }
  for (const wall of map?.walls ?? []) pen.line(wall, colour("wall"), 2.5);
  drawLanes(pen, map?.lanes ?? []);
  drawDoors(pen, map?.doors ?? []);
  drawRoutes(pen, robot);
  for (const [index, range] of scan?.ranges.entries() ?? []) {
    if (range === null || !scan) continue;
    const [x, y, heading] = scan.pose;
    const angle = (heading * Math.PI) / 180 + (2 * Math.PI * index) / scan.ranges.length;
    pen.disc([x + range * Math.cos(angle), y + range * Math.sin(angle)], 1.2, colour("scan"));
  }
  for (const { name, x, y } of namedOn(robot)) if (marked.includes(name)) pen.disc([x, y], HALO, colour("mark"));
  for (const place of map?.places ?? []) {
    pen.line([[place.x - 0.1, place.y], [place.x + 0.1, place.y]], colour("muted"), 1.5);
    pen.line([[place.x, place.y - 0.1], [place.x, place.y + 0.1]], colour("muted"), 1.5);
  }
  for (const { x, y, radius, seen } of objects) pen.mark([x, y], Math.max(3, radius * scale), colour("object"), seen);
  for (const { x, y, radius, seen } of people) pen.mark([x, y], Math.max(4, radius * scale), colour("person"), seen);
  pen.line(path, colour("running"), 2);
  if (pose) drawRobot(pen, robot, pose, [...(map?.places ?? []), ...people, ...objects]);
  for (const { name, x, y, radius } of people) pen.name(name, [x, y], colour("text"), Math.max(4, radius * scale) + 1);
  for (const { name, x, y, radius } of objects) pen.name(name, [x, y], colour("muted"), Math.max(3, radius * scale) + 1);
  for (const { name, x, y } of map?.places ?? []) pen.name(name, [x, y], colour("muted"), 5);
  nameDoors(pen, map?.doors ?? []);
  nameZones(pen, zones);
  pen.names();
}

/** The robot, and the way to its goal. */
function drawRobot(pen: Pen, robot: Robot, pose: [number, number, number], goals: { name: string; x: number; y: number }[]): void {
  const { context, colour, scale } = pen;
  const { way } = robot;
  const here: Point = [pose[0], pose[1]];
  const goal = goals.find(({ name }) => name === robot.doing.goal);
  if (way.length) pen.line(way, colour("running"), 1.5, [4, 5]);
  else if (goal) pen.line([here, [goal.x, goal.y]], colour("running"), 1.5, [4, 5]);
  const size = Math.max(7, ROBOT * scale);
  pen.disc(here, size + 2, colour("surface"));
  pen.disc(here, size, colour("running"));
  const [x, y] = pen.at(here);
  pen.labels.keepFree([x, y], size);
  const heading = (-pose[2] * Math.PI) / 180;
  context.beginPath();
  context.moveTo(x + size * 0.75 * Math.cos(heading), y + size * 0.75 * Math.sin(heading));
  for (const side of [2.4, -2.4]) context.lineTo(x + size * 0.6 * Math.cos(heading + side), y + size * 0.6 * Math.sin(heading + side));
  context.closePath();
  context.fillStyle = colour("surface");
  context.fill();
}

/** What is to be seen, in metres. */
function boundsOf(robot: Robot): Bounds {
  const { map, path, state } = robot;
  const points: Point[] = [...(map?.walls.flat() ?? []), ...path];
  for (const box of map?.boxes ?? []) points.push([box.x - box.width / 2, box.y - box.height / 2], [box.x + box.width / 2, box.y + box.height / 2]);
  for (const each of [...(map?.places ?? []), ...(map?.people ?? []), ...(map?.objects ?? []), ...peopleOf(robot)]) points.push([each.x, each.y]);
  points.push(...(map?.zones ?? []).flatMap((zone) => zone.points), ...(map?.people ?? []).flatMap((person) => person.walks ?? []));
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
