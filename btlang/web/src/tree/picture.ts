// A tree as a picture that needs nothing else: all that is open, in the colours of the page.
import { s } from "../dom";
import type { Status } from "../fleet";
import { showStatus, type Drawing } from "./drawing";
import type { Item, Items, TreeNode } from "./items";
import { lines, type Direction } from "./layout";

const SIDE = 8000; // pixels that a picture has at most; browsers draw no larger ones
const SHARP = 2; // pixels of the picture for one of the page

/** What a tree shows. */
export interface Shown {
  items: { all: Items; rows: Item[] };
  nodes: readonly TreeNode[];
  statuses: readonly Status[];
  size: { width: number; height: number };
  direction: Direction;
  drawing: Drawing;
  family: string;
}

/** As SVG with its own style. */
export function asSvg({ items, nodes, statuses, size, direction, drawing, family }: Shown): Blob {
  const { width, height } = size;
  const everything = new DOMRect(0, 0, width, height);
  const edges = items.rows.map((item) => (item.open ? lines(item, direction, everything) : "")).join("");
  const drawn = items.rows.map((item) => {
    const node = nodes[item.node]!;
    const element = drawing.element(item, node, `node${item.row}`, items.all.isInner(item) ? items.all.count(item) : null, () => undefined);
    showStatus(element, statuses[item.node]!, node);
    element.setAttribute("role", "img");
    return element;
  });
  const svg = s(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, width, height, "font-family": family, "font-size": 14 },
    s("style", {}, style()),
    s("rect", { width, height, fill: colour("--surface") }),
    s("path", { class: "edges", d: edges }),
    ...drawn,
  );
  return new Blob([new XMLSerializer().serializeToString(svg)], { type: "image/svg+xml" });
}

/** An SVG as PNG. */
export async function asPng(svg: Blob): Promise<Blob> {
  const image = new Image();
  image.src = await dataUrl(svg);
  await image.decode();
  const scale = Math.min(SHARP, SIDE / image.width, SIDE / image.height);
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(1, Math.round(image.width * scale));
  canvas.height = Math.max(1, Math.round(image.height * scale));
  canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve, reject) => canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("PNG"))), "image/png"));
}

/** The rules of the page for nodes and edges, with the colours as they are now. */
function style(): string {
  const rules = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules]).filter((rule) => rule instanceof CSSStyleRule);
  const own = rules.filter(({ selectorText }) => /^\.(node|edges|fold)\b/.test(selectorText) && !/:hover|aria-selected|match/.test(selectorText));
  return own.map((rule) => rule.cssText.replace(/var\((--[\w-]+)\)/g, (_, name: string) => colour(name))).join("\n");
}

function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function dataUrl(blob: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result as string);
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(blob);
  });
}
