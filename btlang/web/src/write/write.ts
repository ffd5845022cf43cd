// Missions: a list of those in the library, and one as English and tree side by side.
import { address } from "../address";
import { may, type RequestError } from "../api";
import { fill, h, menuButton, set } from "../dom";
import { downloadItems, pictures, textBlob, type Offer } from "../download";
import { libraryOf } from "../tasks/library";
import { command } from "../tasks/queue";
import { askSchedule } from "../tasks/schedule";
import { t } from "../texts";
import { TreeView } from "../tree/tree_view";
import type { Context, View } from "../view";
import { nodeAt } from "../watch/words";
import { ask } from "./ask";
import { Editor, smallest } from "./editor";
import { messageList } from "./message_list";
import { Player } from "../look_back/player";
import { SavedMission } from "./saved_mission";
import { merge } from "./merge";
import { FileStore, LibraryStore, type Kept, type Store } from "./store";
import { Start } from "./start";
import { Tests } from "./tests";
import { TreeEdits } from "./tree_edits";
import { problemOf, Reader, type Message, type Named, type SaidNode } from "./understood";

const AGAIN = 1000; // milliseconds until a mission is asked for again

/** See `View`. #/write lists, #/write/NAME opens a mission of the library, #/write/file/NAME a file. */
export function openWrite(context: Context): View {
  const [first, second] = context.path;
  if (first === "file" && second) return new Desk(context, new FileStore(second), new FileStore(second.replace(/(\.txt)?$/, ".test.txt"))).view;
  return first ? new Desk(context, new LibraryStore(context, first), new LibraryStore(context, first, "test")).view : openList(context);
}

function openList(context: Context): View {
  const list = h("ul", { class: "tasks" });
  void libraryOf(context.robot).then(
    (missions) => {
      const items = missions.map(({ name, number, person }) =>
        h("li", { class: "card" }, h("span", { class: "number" }, number), h("a", { class: "what", href: address("write", name), dir: "auto" }, name), h("span", { class: "why", dir: "auto" }, person)),
      );
      fill(list, ...(items.length ? items : [h("li", { class: "empty" }, t("write.empty"))]));
    },
    (error: Error) => fill(list, h("li", { class: "problem" }, error.message)),
  );
  const begin = (): void => {
    ask(t("write.new"), [{ name: "name", label: t("write.name"), required: true }], async ({ name }) => {
      location.hash = address("write", name ?? "");
      return "";
    });
  };
  const button = h("button", { type: "button", class: "primary", onclick: begin }, t("write.new"));
  return { element: h("section", { class: "page" }, h("div", { class: "title" }, h("h1", {}, t("tab.write")), may(context.me, "editor") && button), list), close: () => undefined };
}

/** One mission that somebody writes. */
class Desk {
  readonly view: View;
  private title: HTMLElement;
  private state = h("span", { class: "state", role: "status" });
  private company = h("p", { class: "company", role: "status", dir: "auto" });
  private problem = h("p", { class: "problem", role: "alert" });
  private origin = h("div", { class: "offered origin" });
  private offered = h("div", { class: "offered" });
  private messages = h("ol", { class: "messages" });
  private outline = h("select", { "aria-label": t("write.outline") }, h("option", { value: "0" }, t("write.outline")));
  private text = h("div", { class: "text" });
  private save = h("button", { type: "button", class: "primary", onclick: () => void this.keep() }, t("write.keep"));
  private tree = new TreeView({ label: t("write.tree"), select: (node) => this.selected(node), activate: (node) => this.entered(node), menu: (node) => this.edits.commands(node) });
  private reader: Reader;
  private editor: Editor;
  private edits: TreeEdits;
  private tests: Tests;
  private saved: SavedMission;
  private nodes: SaidNode[] = [];
  private understood = "";
  private sort = "english";
  private mayWrite: boolean;
  private closed = false;
  private trial = h("div", { class: "trial", hidden: true });
  private player: Player | null = null;
  private start: Start;
  private unwatch: () => void;
  private leaving = (event: BeforeUnloadEvent): void => {
    this.saved.keepDraft();
    if (this.saved.isChanged) event.preventDefault();
  };

  constructor(
    private context: Context,
    private store: Store,
    tests: Store,
  ) {
    this.mayWrite = may(context.me, "editor");
    this.start = new Start(context, (kind, text) => this.reader.service(kind, text, {}), (text) => (this.editor.text = text));
    this.title = h("h1", { dir: "auto" }, store.name);
    this.reader = new Reader(context.robot, {
      checked: (text, messages, compiles, sort) => this.check(text, messages, compiles, sort),
      understood: (text, nodes, outline) => this.understand(text, nodes, outline),
      failed: (problem) => this.fail(problem),
    });
    this.editor = new Editor("", t("write.text"), {
      reader: this.reader,
      readOnly: true,
      changed: (text) => this.changed(text),
      moved: (at) => this.moved(at),
      keys: [
        { key: "Mod-s", run: () => void this.keep() },
        { key: "F2", run: () => this.rename() },
        { key: "Shift-Alt-f", run: () => void this.format() },
        { key: "Mod-Enter", run: () => this.run() },
        { key: "Alt-Enter", run: () => void this.attempt() },
      ],
    });
    this.saved = new SavedMission(store, this.editor, { told: () => this.tell(), failed: (problem) => this.fail(problem) });
    this.edits = new TreeEdits(this.tree, this.editor, this.reader, (text) => this.fail(text), () => this.mayWrite);
    const mission = { name: store.name, text: () => this.editor.text, show: (start: number, end: number) => this.showWords(start, end) };
    this.tests = new Tests(tests, mission, this.reader, this.mayWrite);
    this.text.append(this.editor.view.dom);
    this.outline.addEventListener("change", () => this.editor.go(Number(this.outline.value)));
    addEventListener("beforeunload", this.leaving);
    this.unwatch = context.presence.watch(() => this.meet());
    this.view = { element: this.element(), close: () => this.close() };
    void this.load();
  }

  private element(): HTMLElement {
    const edit = h("button", { type: "button", "aria-haspopup": "menu" }, t("write.edit"));
    edit.addEventListener("click", () => this.edits.menu(edit));
    const testing = h("button", { type: "button", "aria-expanded": "false", onclick: () => set(testing, { "aria-expanded": String(this.tests.toggle()) }) }, t("tests"));
    const operates = may(this.context.me, "operator");
    const more = menuButton(t("write.more"), () => [
      ...(this.store instanceof LibraryStore && operates ? [{ label: t("write.schedule"), run: () => this.schedule() }] : []),
      ...(this.mayWrite
        ? [
            { label: t("write.format"), run: () => void this.format() },
            { label: t("write.rename"), run: () => this.rename() },
            { label: t("write.undo"), run: () => this.editor.undo() },
            { label: t("write.redo"), run: () => this.editor.redo() },
          ]
        : []),
      ...downloadItems(() => [this.saved.name.replace(/\.\w+$/, ""), Date.now() / 1000], this.offers(), (problem) => this.fail(problem)),
    ]);
    const tools = h(
      "div",
      { class: "controls" },
      this.outline,
      this.mayWrite && this.save,
      this.context.robot && operates && h("button", { type: "button", title: "Ctrl+Enter", onclick: () => this.run() }, t("write.run")),
      h("button", { type: "button", title: "Alt+Enter", onclick: () => void this.attempt() }, t("write.try")),
      testing,
      more,
    );
    const head = h("div", { class: "head" }, h("div", { class: "now" }, this.title, this.state), tools);
    const trunk = h(
      "section",
      { class: "stage card" },
      this.start.element,
      this.trial,
      this.mayWrite && h("div", { class: "doing" }, h("button", { type: "button", title: "Insert", onclick: () => this.edits.addSelected() }, t("write.add")), edit),
      this.tree.element,
    );
    const words = h("section", { class: "stage card said-text" }, this.text, this.problem, this.messages);
    return h("div", { class: "desk" }, head, this.company, this.origin, this.offered, h("div", { class: "panes" }, words, trunk), this.tests.element);
  }

  private close(): void {
    this.closed = true;
    this.saved.keepDraft();
    this.unwatch();
    this.context.presence.write("", false);
    removeEventListener("beforeunload", this.leaving);
    this.reader.close();
    this.tests.close();
    this.player?.close();
    this.start.close();
    this.editor.close();
    this.tree.close();
  }

  // -- saving

  private async load(): Promise<void> {
    try {
      const { text } = await this.saved.load();
      if (/^\s*[<{]/.test(text)) await this.inEnglish(text);
    } catch (error) {
      return this.loadLater(error as RequestError);
    }
    if (this.closed) return;
    const { draft, kept, name } = this.saved;
    fill(this.title, name);
    this.fail("");
    this.editor.apply([smallest("", kept.text)]);
    this.editor.lock(!this.mayWrite);
    const before = draft.read();
    if (before && before.text !== kept.text) this.offer(before);
    this.reader.read(this.editor.text);
    this.start.show(this.mayWrite && !this.editor.text.trim());
    this.tell();
  }

  /** A tree in XML or JSON as a mission beside it, which is there already or begins with its English. */
  private async inEnglish(text: string): Promise<void> {
    const answer = await this.reader.service("english", text, {});
    if (!answer.ok || answer.sort === "english") return;
    const tree = this.saved.name;
    const copy = await this.saved.loadEnglish();
    this.saved.kept = { ...copy, text: copy.revision ? copy.text : answer.text, tree, copy: this.saved.name };
  }

  /** As soon as the robot is back. */
  private loadLater(error: RequestError): void {
    this.fail(this.saved.draft.read() ? `${error.message} ${t("write.draft_waits")}` : error.message);
    const passes = error.status === 0 || error.status === 404 || error.status >= 500; // 404: a server that has just begun knows no robot
    if (passes) setTimeout(() => this.closed || void this.load(), AGAIN);
  }

  /** A draft of an earlier visit. */
  private offer(draft: Kept): void {
    const { kept } = this.saved;
    const take = (): void => {
      fill(this.offered);
      if (draft.revision === kept.revision) this.editor.text = draft.text;
      else merge(t("write.draft_old"), kept, draft.text, (text) => (this.editor.text = text));
    };
    const drop = (): void => {
      fill(this.offered);
      this.saved.draft.clear();
    };
    fill(this.offered, h("span", {}, t("write.draft")), h("button", { type: "button", class: "primary", onclick: take }, t("write.take_draft")), h("button", { type: "button", onclick: drop }, t("write.drop_draft")));
  }

  private async keep(): Promise<void> {
    if (!this.mayWrite) return;
    fill(this.state, t("write.saving"));
    await this.saved.save();
  }

  private tell(): void {
    const { tree, copy, problem } = this.saved.kept;
    fill(this.state, this.saved.state);
    fill(this.origin, tree && (copy ? t("write.of_tree", { tree, copy }) : t("write.onto_tree", { tree })), problem && h("span", { class: "problem", lang: "en" }, problem));
    this.context.presence.write(this.saved.name, this.saved.isChanged);
  }

  /** Who else has it open, before anybody saves. */
  private meet(): void {
    const company = this.context.presence.company;
    if (company !== this.company.textContent) fill(this.company, company);
  }

  // -- the text

  private changed(text: string): void {
    this.start.show(this.mayWrite && !text.trim());
    this.tree.element.ariaBusy = "true";
    this.reader.read(text);
    this.saved.changed();
  }

  private check(text: string, messages: Message[], compiles: boolean, sort: string): void {
    if (text !== this.editor.text) return;
    this.sort = sort;
    if (!text.trim()) messages = []; // that there's no command yet is no mistake
    this.editor.tell(messages);
    fill(this.messages, ...(text.trim() ? messageList(messages, this.editor, this.mayWrite) : []));
    if (!compiles) this.tree.element.classList.add("stale");
  }

  private understand(text: string, nodes: SaidNode[], outline: Named[]): void {
    if (text !== this.editor.text) return;
    this.understood = text;
    fill(this.outline, h("option", { value: "0" }, t("write.outline")), ...outline.map(({ name, start }) => h("option", { value: start }, name)));
    this.tree.element.classList.remove("stale");
    this.tree.element.ariaBusy = "false";
    this.nodes = nodes;
    this.edits.set(nodes, text);
    this.tree.setNodes(nodes, true);
    this.moved(this.editor.view.state.selection.main.head);
  }

  /** The caret shows the node: the smallest that is said there. */
  private moved(at: number): void {
    if (this.understood !== this.editor.text) return;
    const best = nodeAt(this.nodes, at);
    if (best >= 0 && best !== this.tree.selected) this.tree.select(best);
  }

  private selected(node: number): void {
    const said = this.nodes[node];
    if (said && said.start !== null && said.end !== null && this.understood === this.editor.text) this.editor.show(said.start, said.end);
  }

  /** Those of a test that failed: of the text as it was then, at least. */
  private showWords(start: number, end: number): void {
    const { length } = this.editor.text;
    this.editor.show(Math.min(start, length), Math.min(end, length));
    this.moved(Math.min(start, length));
  }

  private entered(node: number): void {
    this.selected(node);
    this.editor.view.focus();
  }

  private async format(): Promise<void> {
    const text = this.editor.text;
    const answer = await this.reader.service("format", text, {});
    if (answer.ok && this.editor.text === text) this.editor.text = answer.text;
    else this.fail(problemOf(answer));
  }

  private rename(): void {
    const text = this.editor.text;
    const at = this.editor.view.state.selection.main.head;
    void this.reader.service("rename", text, { at }).then((found) => {
      if (!found.ok || !found.words) return this.fail(found.messages?.[0]?.message ?? t("write.no_name"));
      ask(t("write.rename"), [{ name: "name", label: t("write.new_name"), value: found.words, required: true }], async ({ name }) => {
        const answer = await this.reader.service("rename", text, { at, name });
        if (!answer.ok) return problemOf(answer);
        if (this.editor.text !== text) return t("write.changed_meanwhile");
        this.editor.apply(answer.changes);
        return "";
      });
    });
  }

  /** What can be downloaded: the text as it is, and the tree that is shown. */
  private offers(): Offer[] {
    const xml = async (): Promise<Blob> => {
      const answer = await this.reader.service("xml", this.editor.text, {});
      if (!answer.ok) throw new Error(problemOf(answer));
      return textBlob(answer.xml);
    };
    const said: Offer = { key: "download.english", ending: "txt", content: async () => textBlob(this.editor.text) };
    return [...(this.sort === "english" ? [said] : []), { key: "download.xml", ending: "xml", content: xml }, ...pictures(this.tree)];
  }

  /** Runs the mission in the simulated world, on the server. */
  private async attempt(): Promise<void> {
    fill(this.state, t("write.trying"));
    const text = this.editor.text;
    const film = await this.reader.service("try", text, {});
    this.tell();
    if (!film.ok) return this.fail(problemOf(film));
    this.player?.close();
    const close = (): void => {
      this.player?.close();
      this.player = null;
      this.editor.light([]);
      fill(this.trial);
      this.trial.hidden = true;
    };
    const player = (this.player = new Player(film, 0, () => undefined, (marked) => this.editor.text === text && this.editor.light(marked)));
    fill(this.trial, h("div", { class: "doing" }, h("h2", {}, t("write.try")), h("button", { type: "button", onclick: close }, t("close"))), player.element);
    this.trial.hidden = false;
  }

  /** Gives the mission to the robot. */
  private run(): void {
    if (!may(this.context.me, "operator")) return;
    void command(this.context, "submit", { text: this.editor.text }).then(
      () => (location.hash = address("robots", this.context.robot)),
      (error: Error) => this.fail(error.message),
    );
  }

  /** Lets the robot do it later, as it's kept. */
  private schedule(): void {
    if (this.saved.isChanged || !this.saved.kept.revision) return this.fail(t("write.save_first"));
    askSchedule(this.context, this.saved.name, (rule) => fill(this.state, t("submit.scheduled", { rule })));
  }

  private fail(problem: string): void {
    fill(this.problem, problem);
  }
}
