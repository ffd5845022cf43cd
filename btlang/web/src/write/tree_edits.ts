// Editing by the tree: each command rewrites only the English that it touches, and is one step of undo.
import { openMenu } from "../dom";
import { t, type Key } from "../texts";
import { TreeDrag } from "../tree/drag";
import type { TreeView } from "../tree/tree_view";
import { ask } from "./ask";
import { changed, smallest, type Editor } from "./editor";
import { choose } from "./palette";
import type { Reader, SaidNode } from "./understood";

/** What nodes can be wrapped in; see `palette` in btlang/editing/palette.py. */
interface Form {
  name: string;
  sort: "command" | "condition";
  needs: string;
  example: string;
}

const CHAINS = ["Sequence", "Fallback", "Parallel"];

type Place = "before" | "after" | "inside";

export class TreeEdits {
  private nodes: SaidNode[] = [];
  private said = "";
  private held: { node: number; do: "copy" | "move"; words: string } | null = null;

  constructor(
    private tree: TreeView,
    private editor: Editor,
    private reader: Reader,
    private say: (text: string) => void,
    private mayEdit: () => boolean,
  ) {
    tree.element.addEventListener("keydown", (event) => this.press(event));
    tree.drag = new TreeDrag(tree, {
      can: (node) => this.isCurrent && this.mayEdit() && this.can(node, "move"),
      accepts: (node, to) => this.isCurrent && this.nodes[to]?.start !== null && this.isCondition(node) === this.isCondition(to),
      drop: (node, to, place) => void this.edit({ do: "move", node, to, place }),
    });
  }

  /** The nodes of a text. */
  set(nodes: SaidNode[], text: string): void {
    this.nodes = nodes;
    this.said = text;
  }

  /** The commands for a node, for its menu. */
  commands(node: number): { label: string; run: () => void }[] {
    const said = this.nodes[node];
    if (!said || !this.mayEdit() || said.start === null) return [];
    const can = (name: string): boolean => this.can(node, name);
    const item = (key: Key, run: () => void, wanted = true) => (wanted ? [{ label: t(key), run: () => this.isSaid() && run() }] : []);
    return [
      ...item("write.add_after", () => this.add(node, "after"), can("insert")),
      ...item("write.add_before", () => this.add(node, "before"), can("insert")),
      ...item("write.add_inside", () => this.add(node, "inside"), can("inside")),
      ...item("write.values", () => this.values(node), (said.values?.length ?? 0) > 0),
      ...item("write.wrap", () => void this.wrap(node), can("wrap")),
      ...item("write.unwrap", () => this.edit({ do: "unwrap", node }), can("unwrap")),
      ...item("write.turn", () => this.edit({ do: "turn", node }), can("turn")),
      ...item("write.name_it", () => this.name(node), can("name")),
      ...item("write.cut", () => this.hold(node, "move"), can("move")),
      ...item("write.copy", () => this.hold(node, "copy"), can("copy")),
      ...item("write.paste", () => this.paste(node, "after"), this.held !== null),
      ...item("write.paste_inside", () => this.paste(node, "inside"), this.held !== null && can("inside")),
      ...item("write.delete", () => this.edit({ do: "delete", node }), can("delete")),
    ];
  }

  /** Opens the menu of the selected node below a button. */
  menu(button: HTMLElement): void {
    const node = this.tree.selected;
    const commands = node === null ? [] : this.commands(node);
    const { left, bottom } = button.getBoundingClientRect();
    if (commands.length) openMenu(left, bottom + 4, t("write.edit"), commands);
    else this.say(t("write.no_edit"));
  }

  /** Adds behind the selected node, or at the end. */
  addSelected(): void {
    const node = this.tree.selected ?? 0;
    if (this.nodes.length && this.isSaid()) this.add(node, node === 0 && CHAINS.includes(this.nodes[0]!.id) ? "inside" : "after");
  }

  private press(event: KeyboardEvent): void {
    const node = this.tree.selected;
    const target = event.target as HTMLElement;
    if (node === null || !this.mayEdit() || target.closest("input, select, textarea")) return;
    const control = event.ctrlKey || event.metaKey;
    const key = `${control ? "Ctrl+" : ""}${event.altKey ? "Alt+" : ""}${event.shiftKey && event.key.length > 1 ? "Shift+" : ""}${event.key.length === 1 ? event.key.toLowerCase() : event.key}`;
    const undoes: Record<string, () => void> = {
      "Ctrl+z": () => (event.shiftKey ? this.editor.redo() : this.editor.undo()),
      "Ctrl+y": () => this.editor.redo(),
    };
    const does: Record<string, () => void> = {
      "Delete": () => this.edit({ do: "delete", node }),
      "Insert": () => this.add(node, "after"),
      "Shift+Insert": () => this.add(node, "before"),
      "F2": () => this.values(node),
      "Ctrl+x": () => this.hold(node, "move"),
      "Ctrl+c": () => this.hold(node, "copy"),
      "Ctrl+v": () => this.paste(node, "after"),
      "Alt+ArrowUp": () => this.step(node, -1),
      "Alt+ArrowDown": () => this.step(node, 1),
    };
    const run = undoes[key] ?? does[key];
    if (!run) return;
    event.preventDefault();
    event.stopPropagation();
    if (key in undoes || this.isSaid()) run();
  }

  /** Does edits on the server, one after the other, and their change here; says what is wrong and returns it, "" for nothing. */
  private async edit(...edits: Record<string, unknown>[]): Promise<string> {
    if (!this.isSaid()) return t("write.changed_meanwhile");
    const before = this.said;
    let [text, start, end] = [before, 0, 0];
    for (const edit of edits) {
      const answer = await this.reader.service("edit", text, { edit });
      if (!answer.ok) {
        const problem = answer.messages?.[0] ? [answer.messages[0].message, answer.messages[0].hint].filter(Boolean).join("\n") : (answer.text ?? "");
        this.say(problem);
        return problem;
      }
      [text, start, end] = [changed(text, answer.changes), answer.start, answer.end];
    }
    if (this.editor.text !== before) return t("write.changed_meanwhile");
    if (text !== before) this.editor.apply([smallest(before, text)], [start, end]);
    this.say("");
    return "";
  }

  private add(node: number, place: Place): void {
    const inside = place === "inside" && !["all", "any"].includes(this.nodes[node]?.id ?? "");
    void choose(this.reader, this.editor.text, this.isCondition(node) && !inside, (words) => this.edit({ do: "insert", node, place, words }));
  }

  private async wrap(node: number): Promise<void> {
    const answer = await this.reader.service("palette", this.editor.text, {});
    if (!answer.ok) return this.say(answer.text ?? "");
    const conditions = this.isCondition(node);
    const forms = new Map((answer.forms as Form[]).filter(({ sort }) => conditions === (sort === "condition")).map((form) => [form.name, form]));
    const siblings = this.following(node);
    const needed = (values: Record<string, string>): string => forms.get(values["form"] ?? "")?.needs ?? "";
    ask(
      t("write.wrap"),
      [
        { name: "form", label: t("write.form"), value: conditions ? "not" : "retry", options: [...forms.keys()].map((value) => ({ value, label: t(`form.${value}` as Key) })) },
        { name: "words", label: t("write.form_words"), value: (values) => forms.get(values["form"] ?? "")?.example ?? "", required: true, shown: (values) => needed(values) !== "" },
        ...(siblings.length ? [{ name: "count", label: t("write.count"), value: "1", number: { min: 1, max: siblings.length + 1 } }] : []),
      ],
      (values) => {
        const count = Number(values["count"] ?? 1);
        const last = count > 1 ? siblings[count - 2] : null;
        return this.edit({ do: "wrap", node, last, form: values["form"], words: needed(values) ? values["words"] : "" });
      },
    );
  }

  private values(node: number): void {
    const known = this.nodes[node]?.values ?? [];
    if (!known.length) return this.say(t("write.no_values"));
    ask(
      t("write.values"),
      known.map(([name, , value]) => ({ name, label: name.replaceAll("_", " "), value })),
      // each is for the same node: a value changes no number of a node
      (values) => this.edit(...known.flatMap(([port, , before]) => (values[port] === before ? [] : [{ do: "value", node, port, words: values[port] }]))),
    );
  }

  private name(node: number): void {
    const siblings = this.following(node);
    ask(
      t("write.name_it"),
      [
        { name: "words", label: t("write.new_name"), required: true },
        ...(siblings.length ? [{ name: "count", label: t("write.count"), value: "1", number: { min: 1, max: siblings.length + 1 } }] : []),
      ],
      ({ words, count }) => this.edit({ do: "name", node, words, last: Number(count ?? 1) > 1 ? siblings[Number(count) - 2] : null }),
    );
  }

  private hold(node: number, what: "copy" | "move"): void {
    this.held = { node, do: what, words: this.editor.text };
    this.say(t(what === "move" ? "write.will_move" : "write.will_copy", { words: this.nodes[node]!.label }));
  }

  private paste(to: number, place: Place): void {
    if (!this.held) return;
    if (this.held.words !== this.editor.text) {
      this.held = null;
      return this.say(t("write.changed_meanwhile"));
    }
    const { node, do: what } = this.held;
    this.held = null;
    void this.edit({ do: what, node, to, place });
  }

  /** Moves a node past its sibling. */
  private step(node: number, by: 1 | -1): void {
    const siblings = this.siblings(node);
    const to = siblings[siblings.indexOf(node) + by];
    if (to !== undefined) void this.edit({ do: "move", node, to, place: by < 0 ? "before" : "after" });
  }

  private siblings(node: number): number[] {
    const { parent, tree } = this.nodes[node]!;
    return parent < 0 ? [node] : this.nodes.flatMap((each, index) => (each.parent === parent && each.tree === tree ? [index] : []));
  }

  private following(node: number): number[] {
    const parent = this.nodes[this.nodes[node]!.parent];
    return parent && CHAINS.includes(parent.id) ? this.siblings(node).filter((each) => each > node) : [];
  }

  private can(node: number, edit: string): boolean {
    const said = this.nodes[node];
    return said !== undefined && said.start !== null && (!said.edits || said.edits.includes(edit));
  }

  /** Whether the nodes are those of the text, and not of one before the latest key. */
  private get isCurrent(): boolean {
    return this.said === this.editor.text;
  }

  /** The same, and says so if they aren't: their numbers are those of an older text. */
  private isSaid(): boolean {
    if (!this.isCurrent) this.say(t("write.changed_meanwhile"));
    return this.isCurrent;
  }

  private isCondition(node: number): boolean {
    return this.nodes[node]?.sort === "condition";
  }
}
