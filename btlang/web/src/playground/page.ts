// The page *Try it* of the site: a mission, how btlang reads it, its tree, and a run of it in the simulated house.
import { fill, h, oncePerFrame, set } from "../dom";
import { Robot, running, type Run } from "../fleet";
import { filled, t } from "../texts";
import en from "../texts/playground.en.json";
import { applyTheme, setTheme } from "../theme";
import { nodesOf } from "../tree/items";
import { TreeView, withoutRules } from "../tree/tree_view";
import { LogView } from "../watch/log";
import { MapView } from "../watch/map";
import { Question } from "../watch/question";
import { Speech } from "../watch/speech";
import { nodeAt, pieces } from "../watch/words";
import { show } from "../write/ask";
import { Editor } from "../write/editor";
import { messageList } from "../write/message_list";
import type { Message, SaidNode } from "../write/understood";
import examples from "./examples.json";
import { Python } from "./python";
import { fragmentOf, MOST, textOf } from "./share";

type Key = keyof typeof en;

const SPEEDS = [1, 2, 4, 8, 1000] as const; // the last one is as fast as the computer can
const PAUSE = 400; // milliseconds without a key until a text is printed
const SITE = document.querySelector<HTMLMetaElement>("meta[name=site]")?.content ?? "./";

/** A text of the playground. All of it is in English, as the site is. */
const own = (key: Key, values: Record<string, string | number> = {}): string => filled(en[key], values);

class TryIt {
  private about = document.querySelector<HTMLTemplateElement>("#help")?.content ?? document.createDocumentFragment();
  private robot = new Robot("house");
  private status = h("p", { class: "state", role: "status" });
  private problem = h("p", { class: "problem", role: "alert" });
  private start = h("button", { type: "button", class: "primary", title: "Ctrl+Enter", disabled: true, onclick: () => void this.run() }, own("run"));
  private stop = h("button", { type: "button", class: "halt", disabled: true, onclick: () => void this.halt() }, own("stop"));
  private speed = h("select", { "aria-label": own("speed") }, ...SPEEDS.map((each) => h("option", { value: each, selected: each === 2 }, each > 8 ? own("speed.most") : `${each} ×`)));
  private choice = h("select", { "aria-label": own("examples") }, h("option", { value: "" }, own("examples")), ...examples.map(([name], index) => h("option", { value: index }, name!)));
  private messages = h("ul", { class: "messages", "aria-label": own("messages"), tabindex: 0 });
  private reading = h("pre", { class: "film-text", lang: "en", tabindex: 0, "aria-label": own("reading") });
  private tree = new TreeView({ label: t("watch.tree"), select: (node) => this.selected(node) });
  private map = new MapView(() => this.robot);
  private speech = new Speech();
  private question = new Question((text) => this.python.ask("hear", text).then((answer) => this.take(answer.news)));
  private log = this.newLog();
  private editor: Editor;
  private python: Python;
  private timer = 0;
  private busy = false; // a text is being read
  private unread = false; // there is a newer one
  private ready = false;
  private shown: Run | null = null; // the run that the tree shows; null for that of the text
  private nodes: SaidNode[] = [];
  private running = false;
  private refused: string | null = null; // the text for which the worker was exchanged
  private notice = ""; // that it was, until the text is changed
  private draw = oncePerFrame(() => this.show());

  constructor() {
    this.editor = new Editor("", t("write.text"), {
      reader: { service: (kind, text, more) => (this.ready && text !== this.refused ? this.ask(kind, text, more) : Promise.resolve({})) },
      readOnly: false,
      changed: () => this.changed(),
      moved: (at) => this.moved(at),
      keys: [{ key: "Mod-Enter", run: () => undefined }], // it's the page's
    });
    addEventListener("keydown", (event) => void (event.key === "Enter" && (event.ctrlKey || event.metaKey) && this.run()));
    this.choice.addEventListener("change", () => this.begin(examples[Number(this.choice.value)]?.[1] ?? ""));
    this.speed.addEventListener("change", () => void this.python.ask("speed", Number(this.speed.value)));
    addEventListener("hashchange", () => void this.open());
    this.furnish();
    fill(document.body, this.header(), this.body());
    this.python = new Python(new URL("./worker.js", import.meta.url), {
      stage: (stage) => this.stage(stage),
      run: (run) => this.advance(run),
      failed: (why) => this.fail(location.protocol === "file:" ? own("file") : own("failed", { why })),
      exchanged: (why) => this.exchanged(why),
    });
    void this.open();
  }

  private header(): HTMLElement {
    return h(
      "header",
      {},
      h("h1", {}, own("title")),
      this.choice,
      h("div", { class: "controls" }, this.start, this.stop, this.speed),
      this.status,
      h("div", { class: "controls others" }, h("button", { type: "button", onclick: () => void this.share() }, own("share")), h("button", { type: "button", onclick: () => this.help() }, own("help")), h("button", { type: "button", title: own("theme"), "aria-label": own("theme"), onclick: () => setTheme(document.documentElement.dataset["theme"] === "dark" ? "light" : "dark") }, "◐"), h("a", { class: "button", href: SITE }, own("docs"))),
    );
  }

  private body(): HTMLElement {
    const text = h("section", { class: "card stage text-card" }, h("div", { class: "text" }, this.editor.view.dom), this.problem, this.messages);
    const reading = h("details", { class: "card reading", open: true }, h("summary", {}, own("reading")), this.reading);
    const place = h("section", { class: "card place", "aria-label": own("house") }, this.map.canvas, this.speech.element, this.question.element);
    return h(
      "main",
      { class: "try" },
      h("div", { class: "column" }, text, reading),
      h("section", { class: "card stage trunk" }, this.tree.element),
      h("div", { class: "column" }, place, h("section", { class: "card events" }, h("h2", {}, own("log")), this.log.element)),
    );
  }

  /** The mission of the address, else the first example; it only runs when somebody clicks. */
  private async open(): Promise<void> {
    const text = await textOf(location.hash);
    if (text === null) this.fail(own("shared.unread"));
    if (text || !this.editor.text) this.begin(text || examples[0]![1]!);
  }

  private begin(text: string): void {
    if (!text || text === this.editor.text) return;
    this.editor.text = text;
    this.editor.view.focus();
  }

  private stage(stage: "python" | "words" | "ready"): void {
    fill(this.status, own(`stage.${stage}`));
    this.ready = stage === "ready";
    set(this.start, { disabled: !this.ready });
    if (!this.ready) return;
    document.body.dataset["ready"] = "";
    void this.python.ask("speed", Number(this.speed.value));
    void this.python.ask("house").then((answer) => this.take(answer.news));
    this.unread = true;
    void this.read();
  }

  // -- the text

  private changed(): void {
    this.choice.value = "";
    this.notice = "";
    this.unread = true;
    if (this.ready && !this.running) this.say(own("stage.ready"), "");
    this.tree.element.ariaBusy = "true";
    clearTimeout(this.timer);
    void this.read();
  }

  /** Reads the newest text, one at a time: of keys that come faster than that, only the last one counts. */
  private async read(): Promise<void> {
    if (this.busy || !this.ready || !this.unread) return;
    const { text } = this.editor;
    if (text === this.refused) return this.fail(this.notice);
    this.busy = true;
    this.unread = false;
    const answer = await this.ask("document", text);
    if (answer.exchanged) return;
    this.busy = false;
    if (text === this.editor.text) this.understand(text, answer);
    if (this.unread) void this.read();
  }

  private understand(text: string, answer: any): void {
    this.fail(answer.problem ?? this.notice);
    const messages: Message[] = text.trim() ? (answer.messages ?? []) : [];
    this.editor.tell(messages);
    fill(this.messages, ...(text.trim() && !answer.problem ? messageList(messages, this.editor) : [h("li", { class: "fine" }, answer.problem ? "" : own("empty"))]));
    for (const element of [this.tree.element, this.reading]) element.classList.toggle("stale", !answer.nodes);
    this.tree.element.ariaBusy = "false";
    if (!answer.nodes) return;
    this.nodes = answer.nodes.map((node: any) => ({ ...node, ...answer.kinds[node.kind] }));
    this.shown = null;
    this.editor.light([]);
    this.tree.setNodes(this.nodes, true);
    this.moved(this.editor.view.state.selection.main.head);
    this.timer = window.setTimeout(() => void this.print(text), PAUSE);
  }

  /** Shows the text as btlang would write it, once nobody types: it takes longer than the tree. */
  private async print(text: string): Promise<void> {
    const answer = await this.ask("english", text);
    if (answer.ok && text === this.editor.text) fill(this.reading, answer.text);
  }

  /** An answer about a text; see btlang/editing/queries.py. */
  private ask(kind: string, text: string, more: object = {}): Promise<any> {
    return this.python.ask("ask", kind, text, JSON.stringify(more));
  }

  /** The caret shows the node: the smallest that is said there. */
  private moved(at: number): void {
    if (this.shown || this.unread) return;
    const best = nodeAt(this.nodes, at);
    if (best >= 0 && best !== this.tree.selected) this.tree.select(best);
  }

  private selected(node: number): void {
    const { start, end } = this.nodes[node] ?? { start: null, end: null };
    const [from, to] = this.shown ? (this.shown.places[node] ?? [null, null]) : [start, end];
    if (from !== null && to !== null && !this.unread) this.editor.show(from, to);
  }

  // -- the run

  private async run(): Promise<void> {
    const { text } = this.editor;
    if (!this.ready || text === this.refused) return;
    set(this.start, { disabled: true });
    const answer = await this.python.ask("begin", text);
    set(this.start, { disabled: !this.ready });
    if (answer.exchanged) return;
    if (!answer.ok) return answer.messages && text === this.editor.text ? this.understand(text, answer) : this.fail(answer.problem ?? "");
    this.fail("");
    this.going(true);
    this.furnish();
    this.take((await this.python.ask("house")).news);
    this.take(answer.news);
  }

  /** A robot in a house, and a log, in which nothing has happened. */
  private furnish(): void {
    this.robot = new Robot("house");
    this.robot.take({ type: "up", robot: "house" });
    const { element } = this.log;
    this.log = this.newLog();
    element.replaceWith(this.log.element);
  }

  private newLog(): LogView {
    return new LogView((node) => this.tree.pick(node));
  }

  private async halt(): Promise<void> {
    const answer = await this.python.ask("stop");
    if (answer.ended) this.advance(answer);
  }

  /** What happened in a run since the last time, and how it ended. */
  private advance(run: any): void {
    this.take(run.news ?? []);
    if (run.problem) this.fail(run.problem);
    if (!run.over && !run.problem) {
      return this.say(own("running", { seconds: Math.floor(run.seconds) }), "");
    }
    this.going(false);
    this.editor.light([]);
    this.say(run.ended ?? "", run.succeeded ? "good" : run.why || run.problem ? "bad" : "");
    if (run.why) this.fail(run.why);
  }

  private take(news: any[] = []): void {
    for (const each of news) {
      this.robot.take({ robot: "house", ...each });
      if (each.type === "run") this.showRun();
      if (each.type !== "statuses") continue;
      if (this.shown) this.tree.setWords((each.words ?? []).map(([node, words]: [number, string]) => [node, words] as const));
      if (this.shown) this.tree.setStatuses(each.changes);
    }
    this.draw();
  }

  private showRun(): void {
    const { run } = this.robot;
    if (!run || this.unread || run.text !== this.editor.text) return;
    this.shown = run;
    this.tree.setNodes(withoutRules(nodesOf(run), run.root));
    this.tree.setStatuses(run.statuses.entries());
  }

  private show(): void {
    const { robot } = this;
    this.map.redraw();
    this.speech.show(robot);
    this.question.show(robot);
    this.log.update(robot.entries);
    if (!this.shown || !this.running) return;
    const leaves = running(this.shown);
    this.editor.light(pieces(leaves.map((node) => this.shown!.places[node] ?? null), null));
    if (leaves.length) this.tree.bring(leaves[0]!);
  }

  private going(running: boolean): void {
    this.running = running;
    set(this.stop, { disabled: !running });
    document.body.toggleAttribute("data-running", running);
  }

  /** What is written isn't read again before it's changed: it may have been the reason. */
  private exchanged(why: "broken" | "slow" | "unstopped"): void {
    this.going(false);
    this.busy = false;
    this.refused = why === "unstopped" ? null : this.editor.text;
    this.notice = own(`exchanged.${why}`);
    this.fail(this.notice);
  }

  // -- the rest

  private async share(): Promise<void> {
    const fragment = await fragmentOf(this.editor.text);
    if (!fragment) return this.fail(own("shared.too_long", { most: MOST }));
    history.replaceState(null, "", fragment);
    const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    this.say(own(copied ? "shared" : "shared.by_hand"), "");
  }

  /** What the site says about the page: its own markup, which is in the page since it was built. */
  private help(): void {
    const dialog = show(own("help"), h("div", { class: "help" }, this.about.cloneNode(true)), h("div", { class: "controls" }, h("button", { type: "button", class: "primary", onclick: () => dialog.close() }, t("close"))));
  }

  private say(words: string, kind: string): void {
    if (this.status.textContent !== words) fill(this.status, words);
    this.status.className = `state ${kind}`;
  }

  private fail(problem: string): void {
    if (this.problem.textContent !== problem) fill(this.problem, problem);
  }
}

applyTheme();
new TryIt();
