// Where each open node is drawn: a tidy tree (Reingold and Tilford, by d3-hierarchy), top-down or left to right.
import { hierarchy, tree, type HierarchyPointNode } from "d3-hierarchy";
import type { Item } from "./items";

export type Direction = "down" | "right";

const LEVELS = { down: 40, right: 44 }; // pixels between two levels
const COUSINS = 22;
const SIBLINGS = 10;
const MARGIN = 24;

/** Sets `x` and `y` of items whose sizes are known; returns the size of all. */
export function place(roots: Item[], direction: Direction): { width: number; height: number } {
  const breadth = (item: Item): number => (direction === "down" ? item.width : item.height);
  const depth = (item: Item): number => (direction === "down" ? item.height : item.width);
  const root = hierarchy<Item | null>(null, (item) => (item ? (item.open ? item.children : null) : roots));
  const layout = tree<Item | null>()
    .nodeSize([1, 1])
    .separation((a, b) => (breadth(a.data!) + breadth(b.data!)) / 2 + (a.parent === b.parent ? SIBLINGS : COUSINS));
  const placed: HierarchyPointNode<Item>[] = [];
  const deepest: number[] = [];
  let least = Infinity;
  layout(root).each((node) => {
    if (!node.data) return;
    placed.push(node as HierarchyPointNode<Item>);
    const level = node.depth - 1;
    deepest[level] = Math.max(deepest[level] ?? 0, depth(node.data));
    least = Math.min(least, node.x - breadth(node.data) / 2);
  });
  const starts: number[] = [];
  deepest.reduce((start, size, level) => {
    starts[level] = start;
    return start + size + LEVELS[direction];
  }, MARGIN);
  let width = 0;
  let height = 0;
  for (const { data: item, x, depth: level } of placed) {
    const across = x - least - breadth(item) / 2 + MARGIN;
    const along = starts[level - 1]!;
    [item.x, item.y] = direction === "down" ? [across, along] : [along, across];
    width = Math.max(width, item.x + item.width + MARGIN);
    height = Math.max(height, item.y + item.height + MARGIN);
  }
  return { width, height };
}

/** Lines from a node to those below it, as the `d` of a path, where they meet a part of the plane. */
export function lines(item: Item, direction: Direction, area: DOMRect): string {
  const children = item.open ? (item.children ?? []) : [];
  const first = children[0];
  const last = children.at(-1);
  if (!first || !last) return "";
  const drawn: string[] = [];
  if (direction === "down") {
    const from = item.x + item.width / 2;
    const bar = first.y - LEVELS.down / 2;
    const [left, right] = [Math.min(from, first.x + first.width / 2), Math.max(from, last.x + last.width / 2)];
    if (first.y < area.top || item.y > area.bottom || right < area.left || left > area.right) return "";
    drawn.push(`M${from} ${item.y + item.height}V${bar}M${left} ${bar}H${right}`);
    for (const child of children) {
      const x = child.x + child.width / 2;
      if (x >= area.left && x <= area.right) drawn.push(`M${x} ${bar}V${child.y}`);
    }
  } else {
    const from = item.y + item.height / 2;
    const bar = first.x - LEVELS.right / 2;
    const [top, bottom] = [Math.min(from, first.y + first.height / 2), Math.max(from, last.y + last.height / 2)];
    if (first.x < area.left || item.x > area.right || bottom < area.top || top > area.bottom) return "";
    drawn.push(`M${item.x + item.width} ${from}H${bar}M${bar} ${top}V${bottom}`);
    for (const child of children) {
      const y = child.y + child.height / 2;
      if (y >= area.top && y <= area.bottom) drawn.push(`M${bar} ${y}H${child.x}`);
    }
  }
  return drawn.join("");
}

/** A line beside an item where another one may come, as the `d` of a path. */
export function gap(item: Item, direction: Direction, after: boolean): string {
  const { x, y, width, height } = item;
  if (direction === "down") return `M${after ? x + width + SIBLINGS / 2 : x - SIBLINGS / 2} ${y - 4}v${height + 8}`;
  return `M${x - 4} ${after ? y + height + SIBLINGS / 2 : y - SIBLINGS / 2}h${width + 8}`;
}
