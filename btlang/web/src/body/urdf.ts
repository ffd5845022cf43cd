// Reads the body of a robot from URDF: links of boxes, cylinders and spheres, and the joints between them. Reading it here,
// in place of the package urdf-loader, saves its loaders of meshes.

export type Vector = [number, number, number];

/** `size` is in metres: x, y and z of a box, radius and length of a cylinder, the radius of a sphere. */
export interface Shape {
  kind: "box" | "cylinder" | "sphere";
  size: number[];
  at: Vector;
  turned: Vector;
}

/** `at` (metres) and `turned` (roll, pitch, yaw in radians) are where it is on its parent. */
export interface Joint {
  name: string;
  kind: "turns" | "slides" | "fixed";
  parent: string;
  child: string;
  at: Vector;
  turned: Vector;
  axis: Vector;
}

export interface Urdf {
  /** The link that is on no other one. */
  root: string;
  links: Map<string, Shape[]>;
  joints: Joint[];
}

const KINDS: Record<string, Joint["kind"]> = { revolute: "turns", continuous: "turns", prismatic: "slides", fixed: "fixed" };
const SIZES: Record<Shape["kind"], (element: Element) => number[]> = {
  box: (element) => numbers(element, "size", 3),
  cylinder: (element) => [...numbers(element, "radius", 1), ...numbers(element, "length", 1)],
  sphere: (element) => numbers(element, "radius", 1),
};

/** Throws an Error with the reason where it's no body: no XML, a number that is none, or links that are no tree. */
export function readUrdf(text: string): Urdf {
  const robot = new DOMParser().parseFromString(text, "application/xml").documentElement;
  if (robot.tagName !== "robot") throw new Error("it has no element 'robot'");
  const links = new Map(children(robot, "link").map((link) => [named(link), children(link, "visual").flatMap(shapesOf)]));
  const joints = children(robot, "joint").map(jointOf);
  return { root: rootOf(links, joints), links, joints };
}

/** The names of the joints that move, in the order in which the robot gives their positions. */
export const moving = (urdf: Urdf): Joint[] => urdf.joints.filter(({ kind }) => kind !== "fixed");

function rootOf(links: Urdf["links"], joints: Joint[]): string {
  const above = new Map<string, string>();
  for (const { name, parent, child } of joints) {
    if (!links.has(parent) || !links.has(child)) throw new Error(`the joint '${name}' is on a link that isn't there`);
    if (above.has(child)) throw new Error(`the link '${child}' is on two joints`);
    above.set(child, parent);
  }
  const [root, ...others] = [...links.keys()].filter((link) => !above.has(link));
  if (root === undefined || others.length) throw new Error("its links are no tree");
  for (const link of links.keys()) {
    let [at, steps] = [link, 0];
    while (at !== root && steps++ <= links.size) at = above.get(at)!;
    if (at !== root) throw new Error("its links are no tree");
  }
  return root;
}

function shapesOf(visual: Element): Shape[] {
  const geometry = children(visual, "geometry")[0]?.firstElementChild;
  const kind = geometry?.tagName as Shape["kind"];
  if (!geometry || !(kind in SIZES)) return []; // a mesh is in another file
  return [{ kind, size: SIZES[kind](geometry), ...placeOf(visual) }];
}

function jointOf(joint: Element): Joint {
  const axis = children(joint, "axis")[0];
  return {
    name: named(joint),
    kind: KINDS[joint.getAttribute("type") ?? ""] ?? "fixed",
    parent: children(joint, "parent")[0]?.getAttribute("link") ?? "",
    child: children(joint, "child")[0]?.getAttribute("link") ?? "",
    ...placeOf(joint),
    axis: axis ? (numbers(axis, "xyz", 3) as Vector) : [1, 0, 0],
  };
}

function placeOf(element: Element): { at: Vector; turned: Vector } {
  const origin = children(element, "origin")[0];
  const vector = (name: string): Vector => (origin?.hasAttribute(name) ? (numbers(origin, name, 3) as Vector) : [0, 0, 0]);
  return { at: vector("xyz"), turned: vector("rpy") };
}

function children(element: Element, tag: string): Element[] {
  return [...element.children].filter((each) => each.tagName === tag);
}

function named(element: Element): string {
  return element.getAttribute("name") ?? "";
}

function numbers(element: Element, name: string, count: number): number[] {
  const found = (element.getAttribute(name) ?? "").trim().split(/\s+/).map(Number);
  if (found.length !== count || !found.every(Number.isFinite)) throw new Error(`'${name}' of '${element.tagName}' needs ${count} numbers`);
  return found;
}
