// A behavior tree with its controls: keys, tools, and nodes that are dragged onto others.
import { TreeDrag, type DragOptions } from "./drag";
import type { TreeNode } from "./items";
import { TreeKeys } from "./keys";
import { toolbar } from "./toolbar";
import { TreeCanvas, type TreeOptions } from "./tree_canvas";

export { joined, withoutRules, type TreeNode } from "./items";

export class TreeView extends TreeCanvas {
  private drag: TreeDrag | null = null;

  constructor(options: TreeOptions) {
    super(options);
    new TreeKeys(this);
    this.element.prepend(toolbar(this));
  }

  override setNodes(nodes: readonly TreeNode[], keep = false): void {
    this.drag?.cancel();
    super.setNodes(nodes, keep);
  }

  /** Lets nodes be dragged onto others. */
  letDrag(options: DragOptions): void {
    this.drag = new TreeDrag(this, options);
  }
}
