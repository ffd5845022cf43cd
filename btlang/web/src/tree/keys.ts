// The keys of a tree, as WAI-ARIA has them.
import type { Item } from "./items";
import type { TreeCanvas } from "./tree_canvas";

const TOGETHER = 700; // milliseconds between two letters of a word that is typed to find a node

export class TreeKeys {
  private typed = "";
  private last = 0;

  constructor(private view: TreeCanvas) {
    view.scroll.addEventListener("keydown", (event) => {
      if (!event.ctrlKey && !event.metaKey && !event.altKey && this.press(event)) event.preventDefault();
    });
  }

  private press(event: KeyboardEvent): boolean {
    const { view } = this;
    const { rows, all } = view.items;
    const item = view.current;
    if (!item) return false;
    const go = (target: Item | null | undefined): true => {
      if (target) view.choose(target);
      return true;
    };
    switch (event.key) {
      case "ArrowDown":
        return go(rows[item.row + 1]);
      case "ArrowUp":
        return go(rows[item.row - 1]);
      case "Home":
        return go(rows[0]);
      case "End":
        return go(rows.at(-1));
      case "ArrowRight":
        if (item.open) return go(item.children?.[0]);
        if (all.isInner(item)) view.unfold(item);
        return true;
      case "ArrowLeft":
        if (!item.open) return go(item.parent);
        view.fold(item);
        return true;
      case "*":
        for (const each of item.parent?.children ?? all.roots) all.open(each);
        view.unfold(item);
        return true;
      case "Enter":
        view.activate(item);
        return true;
      case " ":
        if (all.isInner(item)) view.toggle(item);
        return true;
      case "ContextMenu":
      case "F10":
        return (event.key === "ContextMenu" || event.shiftKey) && view.openMenu(item);
      case "/":
        view.element.querySelector<HTMLElement>("[type=search]")?.focus();
        return true;
    }
    return event.key.length === 1 && this.type(event.key, item);
  }

  private type(letter: string, item: Item): boolean {
    const now = performance.now();
    this.typed = now - this.last < TOGETHER ? this.typed + letter : letter;
    this.last = now;
    const { rows, all } = this.view.items;
    const from = this.typed.length > 1 ? item.row : item.row + 1;
    const wanted = this.typed.toLocaleLowerCase();
    const begins = (each: Item): boolean => {
      const node = all.nodes[each.node]!;
      return (node.label || node.id).toLocaleLowerCase().startsWith(wanted);
    };
    const found = [...rows.slice(from), ...rows.slice(0, from)].find(begins);
    if (found) this.view.choose(found);
    return true;
  }
}
