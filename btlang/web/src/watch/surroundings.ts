// What is around the robot on its map: zones, doors, the routes of people, and who is where.
import type { Door, Lane, Point, Robot, Zone } from "../fleet";
import type { Pen } from "./pen";

const ARROW = 0.12; // metres
const GUEST = 0.25; // metres of the radius of somebody whom the world doesn't name

/** Somebody or something at a place; `seen` is whether the robot sees it, or knows it by its world. */
export interface Standing {
  name: string;
  x: number;
  y: number;
  radius: number;
  seen: boolean;
}

/** Where people are by now. */
export function peopleOf(robot: Robot): Standing[] {
  const { people = [], objects = [] } = robot.map ?? {};
  const named = new Set([...people, ...objects].map(({ name }) => name));
  const guests = robot.things.filter(([name]) => !named.has(name)).map(([name]) => ({ name, x: 0, y: 0, radius: GUEST }));
  return placed(robot, [...people, ...guests]);
}

/** Where objects are by now. */
export function objectsOf(robot: Robot): Standing[] {
  return placed(robot, robot.map?.objects ?? []);
}

/** The zones without those that are only the region of a place: walls show where it ends. */
export function zonesOf(robot: Robot): Zone[] {
  const places = new Set((robot.map?.places ?? []).map(({ name }) => name));
  return (robot.map?.zones ?? []).filter(({ kind, name }) => kind !== "area" || !places.has(name));
}

/** Those that are there. */
function placed(robot: Robot, known: Omit<Standing, "seen">[]): Standing[] {
  const now = new Map(robot.things.map((thing) => [thing[0], thing]));
  return known.flatMap(({ name, x, y, radius }) => {
    const [, nowX, nowY, seen] = now.get(name) ?? [name, x, y, true];
    return nowX === null || nowY === null ? [] : [{ name, x: nowX, y: nowY, radius, seen }];
  });
}

/** The zones, below all else. */
export function drawZones(pen: Pen, zones: Zone[]): void {
  for (const { kind, points } of zones) {
    const paint = pen.colour(kind === "keep out" ? "failure" : kind === "slow" ? "scan" : "muted");
    pen.area(points, paint, kind === "keep out", kind === "open" ? [4, 4] : []);
  }
}

/** Their names, in their middles. */
export function nameZones(pen: Pen, zones: Zone[]): void {
  for (const { name, kind, points } of zones) {
    const middle: Point = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis]!, 0) / points.length) as Point;
    pen.name(name, middle, pen.colour(kind === "keep out" ? "failure" : kind === "slow" ? "skipped" : "muted"), -7);
  }
}

/** Thin lines, with an arrow in the middle of those that lead one way. */
export function drawLanes(pen: Pen, lanes: Lane[]): void {
  const paint = pen.colour("muted");
  for (const { start, end, one_way } of lanes) {
    pen.line([start, end], paint, 0.5);
    const length = Math.hypot(end[0] - start[0], end[1] - start[1]);
    if (!one_way || !length) continue;
    const [along, up] = [(end[0] - start[0]) / length, (end[1] - start[1]) / length].map((part) => part * ARROW) as Point;
    const tip: Point = [(start[0] + end[0]) / 2, (start[1] + end[1]) / 2];
    pen.line([[tip[0] - along - up, tip[1] - up + along], tip, [tip[0] - along + up, tip[1] - up - along]], paint, 1);
  }
}

/** A closed door fills its gap in the wall; the leaf of an open one stands at a right angle to it. */
export function drawDoors(pen: Pen, doors: Door[]): void {
  const paint = pen.colour("accent");
  for (const { start, end, open } of doors) {
    const [across, up] = [end[0] - start[0], end[1] - start[1]];
    if (open) pen.line([start, end], paint, 1, [2, 4]);
    pen.line([start, open ? [start[0] - up, start[1] + across] : end], paint, open ? 2 : 4);
  }
}

/** Their names, beside their gaps. */
export function nameDoors(pen: Pen, doors: Door[]): void {
  for (const { name, start, end } of doors) pen.name(name, [(start[0] + end[0]) / 2, (start[1] + end[1]) / 2], pen.colour("muted"), 5);
}

/** Dots along the ways that people of the world walk. */
export function drawRoutes(pen: Pen, robot: Robot): void {
  for (const { x, y, walks = [] } of robot.map?.people ?? []) {
    if (walks.length) pen.line([[x, y], ...walks], pen.colour("person"), 1.5, [0.5, 5]);
  }
}
