// One node as SVG. A status is a colour, a shape and a word, so that nobody needs the colour.
import { s, set } from "../dom";
import { ANSWERS, type Status } from "../fleet";
import { t, visible } from "../texts";
import type { Item, TreeNode } from "./items";

const LINE = 16;
const TOP = 9;
const GLYPH = 30; // pixels left of the words
const WIDEST = 260;
const MOST_PORTS = 6;
const FOLD = 22;
const HEATS = 4; // colours of how often a node failed

/** In a square of 12 pixels around the origin. */
const SHAPES: Record<Status, string> = {
  IDLE: "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0",
  RUNNING: "M-4 -6L6 0L-4 6Z",
  SUCCESS: "M-6 0L-2 4L6 -5",
  FAILURE: "M-5 -5L5 5M5 -5L-5 5",
  SKIPPED: "M-6 -4L-1 0L-6 4M0 -4L5 0L0 4",
};

/** The answer "no" is no failure. */
const NO = "M-5 0L5 0";

/** What control nodes are drawn with, as on whiteboards. */
const SIGNS: Record<string, string> = {
  Sequence: "→", ReactiveSequence: "⇢", SequenceWithMemory: "→*", Fallback: "?", ReactiveFallback: "?⇢", Parallel: "⇉",
  ParallelAll: "⇉", Inverter: "¬", SubTree: "▣",
};

const pen = document.createElement("canvas").getContext("2d");
const widths = new Map<string, number>();

function width(text: string, font: string): number {
  const key = font + text;
  let found = widths.get(key);
  if (found === undefined && pen) {
    pen.font = font;
    if (widths.size > 20_000) widths.clear();
    widths.set(key, (found = pen.measureText(text).width));
  }
  return found ?? text.length * 8;
}

function cut(given: string, font: string): string {
  const text = visible(given);
  const whole = width(text, font);
  if (whole <= WIDEST) return text;
  return `${text.slice(0, Math.max(1, Math.floor((text.length * WIDEST) / whole) - 1)).trimEnd()}…`;
}

/** The words of a node in the fonts of a tree. */
export class Drawing {
  /** `details`: with ports and conditions. */
  details = false;

  constructor(private family: string) {}

  /** Sets the size of an item. */
  measure(item: Item, node: TreeNode, inner: boolean): void {
    const texts = this.texts(node);
    item.width = Math.ceil(Math.max(...texts.map(({ text, font }) => width(text, font))) + GLYPH + (inner ? FOLD : 0) + 14);
    item.height = texts.length * LINE + 2 * TOP;
  }

  /** The element of an item, without its status. */
  element(item: Item, node: TreeNode, name: string, folded: number | null, toggle: () => void): SVGGElement {
    const texts = this.texts(node);
    const middle = item.height / 2;
    const sign = s("g", { class: "fold", "aria-hidden": "true", onclick: (event: Event) => { event.stopPropagation(); toggle(); }, transform: `translate(${item.width - 14} ${middle})` });
    if (folded !== null) {
      sign.append(s("circle", { r: 9 }), s("text", { y: 4 }, item.open ? "−" : folded > 99 ? "99" : folded));
    }
    const badge = node.differs ? "≠" : node.failed?.join("/");
    return s(
      "g",
      { class: node.differs ? "node differs" : node.failed ? `node often${Math.ceil((HEATS * node.failed[0]) / node.failed[1])}` : "node", id: name, transform: `translate(${item.x} ${item.y})`, role: "treeitem" },
      s("title", {}, node.label ? `${whole(node)}\n${node.id}` : whole(node)),
      s("rect", { width: item.width, height: item.height, rx: 7 }),
      s("path", { class: "status", transform: `translate(16 ${middle})` }),
      ...texts.flatMap(({ text, kind }, line) => [s("text", { class: kind, x: GLYPH, y: TOP + LINE * line + 12 }, text), " "]), // spaces part words for screen readers
      folded !== null && sign,
      badge && s("g", { class: "unlike", "aria-hidden": "true", transform: `translate(${item.width - 4} 2)` }, s("ellipse", { rx: Math.max(9, 5 * badge.length), ry: 9 }), s("text", { y: 4 }, badge)),
    );
  }

  private texts(node: TreeNode): { text: string; font: string; kind: string }[] {
    const main = `14px ${this.family}`;
    const small = `12px ${this.family}`;
    const sign = SIGNS[node.id];
    const words = node.label || node.id;
    const texts = [{ text: cut(sign ? `${sign}  ${words}` : words, main), font: main, kind: "words" }];
    if (!this.details) return texts;
    if (words !== node.id) texts.push({ text: cut(node.id, small), font: small, kind: "port id" });
    const conditions = portsOf(node).filter(([port]) => port.startsWith("_"));
    const ports = portsOf(node).filter(([port]) => !port.startsWith("_"));
    for (const [port, value] of conditions) texts.push({ text: cut(`${port.slice(1)}: ${value}`, small), font: small, kind: "condition" });
    for (const [port, value] of ports.slice(0, MOST_PORTS)) texts.push({ text: cut(`${port} = ${value}`, small), font: small, kind: "port" });
    return texts;
  }
}

/** Shows a status. */
export function showStatus(element: SVGGElement, status: Status, node: TreeNode): void {
  const answer = node.asks ? ANSWERS[status] : undefined;
  element.dataset["status"] = status;
  set(element, { "data-answer": answer });
  element.querySelector(".status")?.setAttribute("d", answer === "FALSE" ? NO : SHAPES[status]);
  const shown = element.querySelector(".words")?.textContent ?? "";
  const id = element.querySelector(".id") && node.id;
  const said = whole(node, id);
  const name = shown.endsWith("…") ? `${shown} ${said}` : said; // a name begins with what is seen of it
  set(element, { "aria-label": `${[name, node.failed?.join("/")].join(" ").trim()}, ${t(`status.${answer ?? status}`)}${node.differs ? `, ${t("compare.differs")}` : ""}` });
}

/** With all that is cut in the drawing, and what is only shown on demand. */
function whole(node: TreeNode, id: string | null = null): string {
  return [label(node), ...(id ? [id] : []), ...portsOf(node).map(([port, value]) => visible(`${port} = ${value}`))].join("\n");
}

/** Its words; its id where it has none. */
export function label(node: TreeNode): string {
  return visible(node.label || node.id);
}

/** Those that the words of a node don't have already, as in "Repeat num_cycles=2". */
function portsOf(node: TreeNode): TreeNode["ports"] {
  return node.ports.filter(([port, value]) => !node.label.includes(`${port}=${value}`));
}
