// Which nodes of a tree are open. A subtree that is defined elsewhere opens in place, also where it holds itself.
import type { Run } from "../fleet";

/** A node as the server gives it; nodes come in preorder. `tree` is the name of the subtree that it's a part of. */
export interface TreeNode {
  /** The number of its parent, -1 for a root. */
  parent: number;
  id: string;
  label: string;
  ports: [name: string, text: string][];
  tree?: string;
  edits?: string[];
  /** It's marked, since it ended otherwise in another run. */
  differs?: boolean;
  /** In how many runs it failed, of how many. */
  failed?: [runs: number, all: number];
  /** It only asks: its failure is the answer "no". */
  asks?: boolean;
  /** Its children but the last only compute values for that one. */
  prepared?: boolean;
  /** The node that stands for it: it isn't shown itself. */
  shownBy?: number;
  /** The node that it says the words of, where it stands for others. */
  says?: number;
}

/** The same nodes, in which one that is prepared stands for all that is done for it, and looks like the last of that. */
export function joined(nodes: readonly TreeNode[]): TreeNode[] {
  const found = nodes.map((node): TreeNode => ({ ...node }));
  const below: number[][] = found.map(() => []);
  found.forEach(({ parent }, index) => parent >= 0 && below[parent]!.push(index));
  for (let index = found.length - 1; index >= 0; index--) {
    const node = found[index]!;
    const last = below[index]!.at(-1);
    if (!node.prepared || last === undefined) continue;
    for (const part of below[index]!) found[part]!.shownBy = index;
    for (const child of below[last]!) found[child]!.parent = index;
    below[index] = below[last]!;
    const { id, label, ports, differs, failed, asks } = found[last]!;
    Object.assign(node, { id, label, ports, asks, says: last, differs: node.differs || differs, failed: node.failed ?? failed });
  }
  return found;
}

/** The nodes of a run as a tree shows them; they come in preorder, with paths such as /0/1. */
export function nodesOf(run: Run): TreeNode[] {
  const numbers = new Map<string, number>();
  const nodes = run.nodes.map(([path, id, label, ports], index) => {
    numbers.set(path, index);
    const above = path.slice(0, path.lastIndexOf("/")) || "/";
    const parent = path === "/" ? -1 : (numbers.get(above) ?? -1);
    return { parent, id, label: label === id ? "" : label, ports: Object.entries(ports ?? {}), prepared: run.prepared.has(index), asks: run.asks.has(index) };
  });
  return joined(nodes);
}

/** The same nodes without those before the first one of a mission, which are of the house rules round it. */
export function withoutRules(nodes: readonly TreeNode[], root: number): TreeNode[] {
  return nodes.map((node, index) => (index < root ? { ...node, shownBy: root } : index === root ? { ...node, parent: -1 } : { ...node }));
}

/** A place where a node is shown. Below a subtree that opens in place, one node may be shown at several. */
export class Item {
  children: Item[] | null = null;
  open = false;
  x = 0;
  y = 0;
  width = 0;
  height = 0;
  row = 0;

  constructor(
    readonly node: number,
    readonly parent: Item | null,
    readonly level: number,
    readonly position: number,
    readonly siblings: number,
  ) {}
}

const AT_FIRST = 150; // nodes that are open when a tree comes

/** The open and folded nodes of a tree. */
export class Items {
  readonly roots: Item[];
  private below: number[][];
  private definitions = new Map<string, number>();
  private uses = new Map<string, number>();

  constructor(readonly nodes: readonly TreeNode[]) {
    this.below = nodes.map(() => []);
    const roots: number[] = [];
    nodes.forEach((node, index) => {
      if (node.shownBy !== undefined) return;
      if (node.parent >= 0) this.below[node.parent]!.push(index);
      else roots.push(index);
      if (node.parent < 0 && node.tree) this.definitions.set(node.tree, index);
    });
    nodes.forEach((node, index) => {
      const name = this.named(index);
      if (name !== null && node.tree !== name && !this.uses.has(name)) this.uses.set(name, index);
    });
    const shown = roots.filter((index) => !this.uses.has(nodes[index]!.tree ?? ""));
    const first = shown.length ? shown : roots.slice(0, 1);
    this.roots = first.map((index, position) => new Item(index, null, 1, position, first.length));
    this.unfold(AT_FIRST);
  }

  /** Whether there is anything below a node. */
  isInner(item: Item): boolean {
    return this.childNodes(item.node).length > 0;
  }

  /** How many nodes are right below one. */
  count(item: Item): number {
    return this.childNodes(item.node).length;
  }

  open(item: Item): void {
    const nodes = this.childNodes(item.node);
    item.children ??= nodes.map((node, position) => new Item(node, item, item.level + 1, position, nodes.length));
    item.open = nodes.length > 0;
  }

  /** Opens level by level until so many nodes are shown. A subtree that holds itself is opened once. */
  unfold(most: number): void {
    let level = [...this.roots];
    let count = level.length;
    while (level.length) {
      const next: Item[] = [];
      for (const item of level) {
        if (this.isRepeated(item) || count + this.count(item) > most) continue;
        this.open(item);
        const children = item.children ?? [];
        count += children.length;
        next.push(...children);
      }
      level = next;
    }
  }

  foldAll(): void {
    for (const item of this.visible()) if (item.parent) item.open = false;
  }

  /** What is shown, in preorder. */
  visible(): Item[] {
    const found: Item[] = [];
    const waiting = [...this.roots].reverse();
    while (waiting.length) {
      const item = waiting.pop()!;
      item.row = found.length;
      found.push(item);
      if (item.open && item.children) for (let i = item.children.length - 1; i >= 0; i--) waiting.push(item.children[i]!);
    }
    return found;
  }

  /** Where a node is shown, opening what it's in; null if there is no such node. */
  reveal(node: number): Item | null {
    const way: number[] = [];
    const passed = new Set<number>();
    for (let at = node; at >= 0; ) {
      const found = this.nodes[at];
      if (!found || passed.has(at)) return null;
      if (found.shownBy !== undefined) {
        at = found.shownBy;
        continue;
      }
      passed.add(at);
      way.push(at);
      at = found.parent >= 0 ? found.parent : (this.uses.get(found.tree ?? "") ?? -1);
      if (this.roots.some((root) => root.node === way.at(-1))) break;
    }
    let item = this.roots.find((root) => root.node === way.at(-1)) ?? null;
    for (const next of way.reverse().slice(1)) {
      if (!item) return null;
      this.open(item);
      item = item.children?.find((child) => child.node === next) ?? null;
    }
    return item;
  }

  private childNodes(node: number): number[] {
    const own = this.below[node]!;
    if (own.length) return own;
    const name = this.named(node);
    const root = name === null ? undefined : this.definitions.get(name);
    return root === undefined ? own : [root];
  }

  private named(index: number): string | null {
    const node = this.nodes[index]!;
    return node.id === "SubTree" ? (node.ports.find(([name]) => name === "ID")?.[1] ?? node.label) : null;
  }

  private isRepeated(item: Item): boolean {
    const name = this.named(item.node);
    for (let above = item.parent; name !== null && above; above = above.parent) if (this.named(above.node) === name) return true;
    return false;
  }
}
