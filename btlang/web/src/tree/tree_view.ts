// A behavior tree with its controls: keys and tools.
import type { TreeNode } from "./items";
import { TreeKeys } from "./keys";
import { toolbar } from "./toolbar";
import { TreeCanvas, type TreeOptions } from "./tree_canvas";

export { joined, withoutRules, type TreeNode } from "./items";

export class TreeView extends TreeCanvas {
  /** What lets its nodes be dragged onto others, where they may be. */
  drag: { cancel: () => void } | null = null;

  constructor(options: TreeOptions) {
    super(options);
    new TreeKeys(this);
    this.element.prepend(toolbar(this));
  }

  override setNodes(nodes: readonly TreeNode[], keep = false): void {
    this.drag?.cancel();
    super.setNodes(nodes, keep);
  }
}
