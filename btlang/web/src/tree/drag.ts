// Nodes dragged onto others by mouse, pen or finger. Who can't do that has the menu of a node.
import type { Item } from "./items";
import type { TreeCanvas } from "./tree_canvas";

/** What may be dragged, where to, and what is to be done then; nodes are meant by their numbers. */
export interface DragOptions {
  can: (node: number) => boolean;
  accepts: (node: number, to: number) => boolean;
  drop: (node: number, to: number, place: "before" | "after") => void;
}

interface Held {
  item: Item;
  pointer: number;
  touch: boolean;
  x: number;
  y: number;
  timer: ReturnType<typeof setTimeout> | undefined;
}

const PRESS = 350; // milliseconds after which a finger lifts a node: before that it scrolls
const STILL = 6; // pixels that a pointer may move and still stands
const EDGE = 32; // pixels from the edge of the view in which it scrolls
const STEP = 12;

export class TreeDrag {
  private held: Held | null = null;
  private lifted = false;
  private moved = false;
  private target: { item: Item; after: boolean } | null = null;
  private listening = new AbortController();

  constructor(
    private view: TreeCanvas,
    private options: DragOptions,
  ) {
    view.scroll.addEventListener("pointerdown", (event) => this.press(event));
    // a long press is the browser's wish for a menu, too: it opens if the finger doesn't move
    view.scroll.addEventListener("contextmenu", (event) => {
      if (!this.held?.touch) return;
      event.preventDefault();
      event.stopImmediatePropagation();
    }, { capture: true });
    view.scroll.addEventListener("touchmove", (event) => this.lifted && event.preventDefault(), { passive: false });
  }

  /** Everything stays where it is. */
  cancel(): void {
    if (!this.held) return;
    clearTimeout(this.held.timer);
    this.listening.abort();
    this.view.lift(this.held.item, false);
    this.view.showDrop(null, false);
    this.held = this.target = null;
    this.lifted = this.moved = false;
  }

  private press(event: PointerEvent): void {
    this.cancel();
    const element = event.target as Element;
    const item = element.closest(".fold") ? null : this.view.itemAt(element);
    if (!item || !event.isPrimary || event.button !== 0 || !this.options.can(item.node)) return;
    const touch = event.pointerType === "touch";
    this.held = { item, pointer: event.pointerId, touch, x: event.clientX, y: event.clientY, timer: touch ? setTimeout(() => this.lift(), PRESS) : undefined };
    this.listening = new AbortController();
    const { signal } = this.listening;
    addEventListener("pointermove", (event) => this.move(event), { signal });
    addEventListener("pointerup", (event) => this.release(event), { signal });
    addEventListener("pointercancel", () => this.cancel(), { signal });
    addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || !this.lifted) return;
      event.preventDefault();
      event.stopPropagation();
      this.cancel();
    }, { signal, capture: true });
  }

  private lift(): void {
    this.lifted = true;
    this.view.scroll.setPointerCapture(this.held!.pointer);
    this.view.lift(this.held!.item, true);
  }

  private move(event: PointerEvent): void {
    const { held } = this;
    if (!held || event.pointerId !== held.pointer) return;
    this.moved ||= Math.hypot(event.clientX - held.x, event.clientY - held.y) > STILL;
    if (!this.moved) return;
    if (!this.lifted && held.touch) return this.cancel();
    if (!this.lifted) this.lift();
    this.aim(held.item, event.clientX, event.clientY);
  }

  private aim(dragged: Item, x: number, y: number): void {
    const { view } = this;
    const box = view.scroll.getBoundingClientRect();
    const towards = (at: number, from: number, to: number): number => (at < from + EDGE ? -STEP : at > to - EDGE ? STEP : 0);
    view.scroll.scrollBy(towards(x, box.left, box.right), towards(y, box.top, box.bottom));
    const element = document.elementFromPoint(x, y);
    const item = view.itemAt(element);
    this.target = null;
    if (item && !isInside(item, dragged.node) && this.options.accepts(dragged.node, item.node)) {
      const { left, top, width, height } = element!.closest(".node")!.getBoundingClientRect();
      this.target = { item, after: view.direction === "down" ? x > left + width / 2 : y > top + height / 2 };
    }
    view.showDrop(this.target?.item ?? null, this.target?.after ?? false);
  }

  private release(event: PointerEvent): void {
    const { held, target, lifted, moved } = this;
    if (!held || event.pointerId !== held.pointer) return;
    this.cancel();
    if (target) this.options.drop(held.item.node, target.item.node, target.after ? "after" : "before");
    else if (lifted && !moved) this.view.openMenu(held.item, event.clientX, event.clientY);
  }
}

function isInside(item: Item, node: number): boolean {
  for (let at: Item | null = item; at; at = at.parent) if (at.node === node) return true;
  return false;
}
