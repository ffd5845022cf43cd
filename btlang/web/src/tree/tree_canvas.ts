// A behavior tree that scrolls and folds. Only what is in view is in the document.
import { h, oncePerFrame, openMenu, s, set } from "../dom";
import type { Status } from "../fleet";
import { Drawing, label, showStatus } from "./drawing";
import { Items, type Item, type TreeNode } from "./items";
import { gap, lines, place, type Direction } from "./layout";
import type { Shown } from "./picture";

/** `select` and `activate` get the number of a node; `menu` gives the commands of one, for its context menu. */
export interface TreeOptions {
  label: string;
  select?: (node: number) => void;
  activate?: (node: number) => void;
  menu?: (node: number) => { label: string; run: () => void }[];
}

const AROUND = 200; // pixels around what is in view that are drawn, too
const FAMILY = "system-ui, sans-serif";
const ZOOMS = { least: 0.2, most: 2 };
let trees = 0;

export class TreeCanvas {
  readonly element = h("div", { class: "tree" });
  readonly items = { all: new Items([]), rows: [] as Item[] };
  /** Where the keys are. */
  current: Item | null = null;
  direction: Direction = "right";
  private nodes: readonly TreeNode[] = [];
  private statuses: Status[] = [];
  private matches = new Set<number>();
  private zoom = 1;
  private size = { width: 0, height: 0 };
  private drawn = new Map<Item, SVGGElement>();
  private changed = new Set<number>();
  private name = `tree${++trees}`;
  private drawing = new Drawing(FAMILY);
  private edges = s("path", { class: "edges", role: "none" });
  private layer = s("g", { role: "none" });
  private dropMark = s("path", { class: "drop", role: "none" });
  private scaled = s("g", { role: "none" }, this.edges, this.layer, this.dropMark);
  private svg = s("svg", { role: "none" }, this.scaled);
  private plane = h("div", { class: "plane", role: "none" }, this.svg);
  readonly scroll: HTMLElement;
  private redraw = oncePerFrame(() => this.draw());
  private paint = oncePerFrame(() => this.paintStatuses());
  private reword = oncePerFrame(() => this.arrange());
  private unseen = false;
  private resized = new ResizeObserver(() => (this.unseen ? this.begin() : this.redraw()));

  constructor(private options: TreeOptions) {
    this.scroll = h("div", { class: "scroll", role: "tree", tabindex: 0, "aria-label": options.label });
    this.scroll.append(this.plane);
    this.scroll.addEventListener("scroll", () => this.redraw(), { passive: true });
    this.scroll.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.scroll.addEventListener("click", (event) => this.clicked(event, (item) => this.choose(item)));
    this.scroll.addEventListener("dblclick", (event) => this.clicked(event, (item) => this.options.activate?.(item.node)));
    this.scroll.addEventListener("contextmenu", (event) => this.clicked(event, (item) => {
      if (this.openMenu(item, event.clientX, event.clientY)) event.preventDefault();
    }));
    this.element.append(this.scroll);
    this.resized.observe(this.scroll);
  }

  /** Shows another tree; with `keep` the same one after an edit, so folds, selection and place stay where they can. */
  setNodes(nodes: readonly TreeNode[], keep = false): void {
    const open = keep ? new Set(this.items.rows.filter((item) => item.open).map((item) => item.node)) : null;
    const selected = keep && this.scroll.classList.contains("chosen") ? this.selected : null;
    this.nodes = nodes;
    this.items.all = new Items(nodes);
    this.statuses = nodes.map(() => "IDLE");
    this.matches.clear();
    this.current = null;
    this.scroll.classList.remove("chosen");
    if (open) for (const node of open) if (node < nodes.length) this.items.all.open(this.items.all.reveal(node) ?? this.items.all.roots[0]!);
    if (!keep) this.scroll.scrollTo(0, 0);
    this.arrange();
    if (selected !== null && selected < nodes.length) this.select(selected, false);
    else if (!keep) this.begin();
  }

  /** New statuses, drawn together before the next picture. */
  setStatuses(changes: Iterable<readonly [node: number, status: Status]>): void {
    for (const [node, status] of changes) {
      this.statuses[node] = status;
      this.changed.add(node);
    }
    this.paint();
  }

  /** New words of nodes; those of a node that another one stands for are its words, if it says them. */
  setWords(changes: Iterable<readonly [node: number, words: string]>): void {
    let shown = false;
    for (const [node, words] of changes) {
      let at = node;
      for (let by = this.nodes[at]?.shownBy; by !== undefined && this.nodes[by]!.says === at; by = this.nodes[at]!.shownBy) at = by;
      const found = this.nodes[at];
      if (!found || found.shownBy !== undefined || found.label === words) continue;
      found.label = words;
      shown = true;
    }
    if (shown) this.reword();
  }

  /** The number of the selected node. */
  get selected(): number | null {
    return this.current?.node ?? null;
  }

  /** Selects a node from outside, which isn't said to `options.select`; with `scroll` it comes into view. */
  select(node: number | null, scroll = true): void {
    const item = node === null ? null : this.items.all.reveal(node);
    if (item && this.items.rows[item.row] !== item) this.arrange();
    this.move(item, scroll);
  }

  /** Selects a node as a click on it does. */
  pick(node: number): void {
    this.select(node);
    this.options.select?.(node);
  }

  /** Brings a node into view, where it isn't. */
  bring(node: number): void {
    const item = this.items.all.reveal(node);
    if (!item) return;
    if (this.items.rows[item.row] !== item) this.arrange();
    this.show(item);
  }

  /** Moves the keys to an item, and says so. */
  choose(item: Item): void {
    this.move(item, true);
    this.options.select?.(item.node);
  }

  activate(item: Item): void {
    this.options.activate?.(item.node);
  }

  /** The context menu of an item; false if it has no commands. */
  openMenu(item: Item, x?: number, y?: number): boolean {
    const commands = this.options.menu?.(item.node) ?? [];
    if (!commands.length) return false;
    this.choose(item);
    const box = this.drawn.get(item)?.getBoundingClientRect() ?? this.scroll.getBoundingClientRect();
    openMenu(x ?? box.left + 20, y ?? box.bottom, label(this.nodes[item.node]!), commands);
    return true;
  }

  /** The item of a node that an element of this tree is, or is a part of. */
  itemAt(element: Element | null): Item | null {
    const found = element?.closest(".node");
    return (found && this.scroll.contains(found) && this.items.rows[Number(found.id.split("-")[1])]) || null;
  }

  /** Shows that an item is being dragged. */
  lift(item: Item, lifted: boolean): void {
    this.scroll.classList.toggle("dragging", lifted);
    this.drawn.get(item)?.classList.toggle("lifted", lifted);
  }

  /** Marks where something would be dropped: before or after an item; null for nowhere. */
  showDrop(item: Item | null, after: boolean): void {
    this.dropMark.setAttribute("d", item ? gap(item, this.direction, after) : "");
  }

  fold(item: Item): void {
    item.open = false;
    for (let at = this.current; at; at = at.parent) if (at === item) this.current = item;
    this.rearrange(item);
  }

  unfold(item: Item): void {
    this.items.all.open(item);
    this.rearrange(item);
  }

  toggle(item: Item): void {
    if (item.open) this.fold(item);
    else this.unfold(item);
  }

  foldAll(): void {
    this.items.all.foldAll();
    this.arrange();
  }

  unfoldAll(): void {
    this.items.all.unfold(20_000);
    this.arrange();
  }

  /** Marks the nodes with some words, and returns their numbers. */
  find(words: string): number[] {
    const wanted = words.trim().toLocaleLowerCase();
    const found = (node: TreeNode): boolean => node.shownBy === undefined && [node.id, node.label, ...node.ports.flat()].some((text) => text.toLocaleLowerCase().includes(wanted));
    const all = wanted ? this.nodes.flatMap((node, index) => (found(node) ? [index] : [])) : [];
    this.matches = new Set(all);
    this.forget();
    return all;
  }

  turn(): void {
    this.direction = this.direction === "down" ? "right" : "down";
    this.arrange();
    if (this.current) this.show(this.current);
  }

  get details(): boolean {
    return this.drawing.details;
  }

  set details(shown: boolean) {
    this.drawing.details = shown;
    this.arrange();
  }

  /** Keeps a point of the window where it is, by default the middle. */
  zoomBy(factor: number, x = this.scroll.clientWidth / 2, y = this.scroll.clientHeight / 2): void {
    const zoom = Math.min(ZOOMS.most, Math.max(ZOOMS.least, this.zoom * factor));
    const [left, top] = [(this.scroll.scrollLeft + x) / this.zoom, (this.scroll.scrollTop + y) / this.zoom];
    this.zoom = zoom;
    this.grow();
    this.scroll.scrollTo(left * zoom - x, top * zoom - y);
    this.redraw();
  }

  /** All of it in view. */
  fit(): void {
    const { clientWidth, clientHeight } = this.scroll;
    this.zoomBy(Math.min(1.2, clientWidth / this.size.width, clientHeight / this.size.height) / this.zoom);
    this.scroll.scrollTo(0, 0);
  }

  /** For pictures. */
  get shown(): Shown {
    const { items, nodes, statuses, size, direction, drawing } = this;
    return { items, nodes, statuses, size, direction, drawing, family: FAMILY };
  }

  close(): void {
    this.resized.disconnect();
  }

  private wheel(event: WheelEvent): void {
    if (!event.ctrlKey) return;
    event.preventDefault();
    const box = this.scroll.getBoundingClientRect();
    this.zoomBy(Math.exp(-event.deltaY / 300), event.clientX - box.left, event.clientY - box.top);
  }

  private clicked(event: Event, act: (item: Item) => void): void {
    const item = this.itemAt(event.target as Element);
    if (item) act(item);
  }

  private move(item: Item | null, scroll: boolean): void {
    this.current = item;
    this.scroll.classList.toggle("chosen", item !== null); // not so the first node, at which the keys begin
    if (item && scroll) this.show(item);
    this.draw();
  }

  /** At the root, as soon as there is room. */
  private begin(): void {
    this.unseen = this.scroll.clientHeight === 0;
    if (this.current) this.show(this.current);
    this.redraw();
  }

  private show(item: Item): void {
    const { scrollLeft, scrollTop, clientWidth, clientHeight } = this.scroll;
    const into = (at: number, size: number, from: number, whole: number): number => {
      const inside = at * this.zoom >= from + 8 && (at + size) * this.zoom <= from + whole - 8;
      return inside ? from : (at + size / 2) * this.zoom - whole / 2;
    };
    this.scroll.scrollTo(into(item.x, item.width, scrollLeft, clientWidth), into(item.y, item.height, scrollTop, clientHeight));
  }

  private rearrange(item: Item): void {
    const [x, y] = [item.x, item.y];
    this.arrange();
    this.scroll.scrollBy((item.x - x) * this.zoom, (item.y - y) * this.zoom);
  }

  private arrange(): void {
    const { all } = this.items;
    this.items.rows = all.visible();
    for (const item of this.items.rows) this.drawing.measure(item, this.nodes[item.node]!, all.isInner(item));
    this.size = place(all.roots, this.direction);
    this.current ??= this.items.rows[0] ?? null;
    this.grow();
    this.forget();
  }

  private grow(): void {
    this.plane.style.width = `${this.size.width * this.zoom}px`;
    this.plane.style.height = `${this.size.height * this.zoom}px`;
    this.scaled.setAttribute("transform", `scale(${this.zoom})`);
  }

  private forget(): void {
    this.layer.replaceChildren();
    this.drawn.clear();
    this.draw();
  }

  private draw(): void {
    const { scrollLeft, scrollTop, clientWidth, clientHeight } = this.scroll;
    const area = new DOMRect((scrollLeft - AROUND) / this.zoom, (scrollTop - AROUND) / this.zoom, (clientWidth + 2 * AROUND) / this.zoom, (clientHeight + 2 * AROUND) / this.zoom);
    let edges = "";
    for (const item of this.items.rows) {
      if (item.open) edges += lines(item, this.direction, area);
      const seen = item === this.current || (item.x < area.right && item.x + item.width > area.left && item.y < area.bottom && item.y + item.height > area.top);
      if (seen && !this.drawn.has(item)) this.add(item);
      else if (!seen) {
        this.drawn.get(item)?.remove();
        this.drawn.delete(item);
      }
    }
    this.edges.setAttribute("d", edges);
    this.mark();
  }

  private add(item: Item): void {
    const node = this.nodes[item.node]!;
    const inner = this.items.all.isInner(item);
    const element = this.drawing.element(item, node, `${this.name}-${item.row}`, inner ? this.items.all.count(item) : null, () => this.toggle(item));
    set(element, {
      "aria-level": item.level, "aria-posinset": item.position + 1, "aria-setsize": item.siblings,
      "aria-expanded": inner ? String(item.open) : null,
    });
    element.classList.toggle("match", this.matches.has(item.node));
    showStatus(element, this.statuses[item.node]!, node);
    this.layer.append(element);
    this.drawn.set(item, element);
  }

  private mark(): void {
    for (const [item, element] of this.drawn) {
      const marked = String(item === this.current);
      if (element.getAttribute("aria-selected") !== marked) element.setAttribute("aria-selected", marked);
    }
    set(this.scroll, { "aria-activedescendant": this.current && this.drawn.has(this.current) ? `${this.name}-${this.current.row}` : null });
  }

  private paintStatuses(): void {
    for (const [item, element] of this.drawn) {
      if (this.changed.has(item.node)) showStatus(element, this.statuses[item.node]!, this.nodes[item.node]!);
    }
    this.changed.clear();
  }
}
