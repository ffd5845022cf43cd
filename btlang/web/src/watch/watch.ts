// A robot at work: its tree, its map, what it says and does, why it failed, and what may be asked of it.
import { address } from "../address";
import { may } from "../api";
import { fill, h, oncePerFrame, set } from "../dom";
import { entryOf, running, type Rule, type Run } from "../fleet";
import { oldness, state } from "../robots";
import { called, command, Queue } from "../tasks/queue";
import { submitForm } from "../tasks/submit";
import { t, type Key } from "../texts";
import { nodesOf } from "../tree/items";
import { TreeView, withoutRules } from "../tree/tree_view";
import type { Context, View } from "../view";
import { Body } from "./body";
import { Failure } from "./failure";
import { LogView } from "./log";
import { MapView, nodeNaming } from "./map";
import { Offers } from "./offers";
import type { Parts } from "./parts";
import { Question } from "./question";
import { RuleStrip } from "./rules";
import { Speech } from "./speech";
import type { Talk } from "./talk";
import type { LiveValues } from "./values";
import { Voice } from "./voice";
import { nodeAt, pieces, Words } from "./words";

const MOST_RUNNING = 12; // that are listed

/** See `View`. */
export function openWatch(context: Context): View {
  return new Watch(context);
}

class Watch implements View {
  readonly element: HTMLElement;
  private robot;
  private run: Run | null = null;
  private running = h("ul", { class: "running", "aria-label": t("watch.running") });
  private follow = h("button", { type: "button", "aria-pressed": "true", onclick: () => set(this.follow, { "aria-pressed": String(this.follow.getAttribute("aria-pressed") !== "true") }) }, t("watch.follow"));
  private pill = h("span", { class: "pill" });
  private title = h("h1", { dir: "auto" });
  private speech = new Speech();
  private problem = h("p", { class: "problem", role: "alert" });
  private gone = h("p", { class: "gone", role: "status" });
  private controls = h("div", { class: "controls", role: "group", "aria-label": t("watch.controls") });
  private chosen = -1; // the node that somebody selected, -1 for none
  private tree = new TreeView({ label: t("watch.tree"), select: (node) => this.choose(node) });
  private empty = h("p", { class: "empty" }, t("watch.nothing"));
  private first = h("p", { class: "empty", hidden: true }, h("a", { class: "button primary", href: address("write", t("watch.first_name")) }, t("watch.first")));
  private words = new Words((at) => this.selectAt(at));
  private rules = new RuleStrip((rule) => this.showRule(rule));
  private withRules = false; // the tree has the house rules, too
  private text = h("div", { class: "card text-card", hidden: true }, this.words.element);
  private map = new MapView(() => this.robot, (name) => this.choose(nodeNaming((this.run?.nodes ?? []).map((_, node) => this.valuesOf(node)), name, this.chosen), true));
  private log = new LogView((node) => this.choose(node, true));
  private visitor = h("button", { type: "button", class: "visitor", hidden: true, onclick: () => void this.act("visitor", {}) }, t("visitor"));
  private place: HTMLElement;
  private body: Body;
  private offers: Offers;
  private question: Question;
  private talk: Talk | null = null;
  private voice: Voice;
  private side: HTMLElement;
  private parts: Parts | null = null;
  private values: LiveValues | null = null;
  private failure: Failure;
  private queue: Queue;
  private unwatch: () => void;
  private refresh = oncePerFrame(() => this.show());
  private shownControls = "";
  private closed = false;

  constructor(private context: Context) {
    this.robot = context.fleet.get(context.robot);
    this.body = new Body(context);
    this.offers = new Offers(context);
    this.question = new Question(may(context.me, "operator") ? (text) => command(context, "answer", { text }) : null);
    this.voice = new Voice(context);
    this.failure = new Failure((path) => this.select(path));
    this.queue = new Queue(context, () => this.refresh());
    const operates = may(context.me, "operator");
    this.place = h("div", { class: "card place" }, this.body.element, this.map.canvas, h("div", { class: "beside" }, this.voice.element, this.visitor), this.speech.element, this.question.element);
    this.element = h(
      "section",
      { class: "watch" },
      h("div", { class: "head" }, h("div", { class: "now" }, this.pill, this.title), this.controls, this.problem, this.gone, this.offers.element, this.rules.element),
      h("div", { class: "stage card" }, this.failure.element, h("div", { class: "doing" }, this.running, this.follow), this.empty, this.first, this.tree.element),
      h(
        "div",
        { class: "script" },
        operates && h("details", { class: "card" }, h("summary", {}, t("submit.title")), submitForm(context)),
        this.text,
        h("div", { class: "card events" }, h("h2", {}, t("log")), this.log.element),
      ),
      this.side = h("div", { class: "side" }, this.place),
    );
    this.unwatch = context.fleet.watch((robot, kind, news) => {
      if (robot !== this.robot) return;
      this.values?.note(kind);
      if (kind === "statuses" && news?.["run"] === this.run?.id) {
        this.tree.setWords(news!["words"] ?? []);
        this.tree.setStatuses(news!["changes"]);
      }
      if (kind === "event") {
        const entry = entryOf(news!);
        const failed = entry.event.event === "end" ? entry.event.path : "";
        this.failure.note(entry, this.robot.run?.text ?? "", this.robot.run?.nodes.find(([path]) => path === failed)?.[2] ?? "");
        this.voice.note(entry);
      }
      if (kind === "up") this.body.close(); // it may have another body by now
      if (kind === "run" && news!["task"]) {
        this.failure.clear();
        this.values?.begin();
      }
      this.refresh();
    });
    this.show();
    void this.complete();
  }

  close(): void {
    this.closed = true;
    this.unwatch();
    this.queue.close();
    this.map.close();
    this.body.close();
    this.parts?.close();
    this.talk?.close();
    this.voice.close();
    this.tree.close();
  }

  /** Adds what nobody needs at first. */
  private async complete(): Promise<void> {
    const [{ LiveValues }, { Parts }, { Talk }] = await Promise.all([import("./values"), import("./parts"), import("./talk")]);
    if (this.closed) return;
    this.values = new LiveValues(this.robot);
    this.parts = new Parts(this.context);
    this.talk = new Talk(this.context);
    this.place.append(this.talk.element);
    this.side.append(this.values.element, this.parts.element);
    this.refresh();
  }

  private show(): void {
    const { robot } = this;
    const ruled = this.ruled;
    this.rules.show(ruled?.rules ?? [], ruled?.statuses ?? []);
    this.showRun(this.withRules && ruled ? ruled : robot.run);
    const task = this.queue.underway;
    const [kind, words] = state(robot);
    this.pill.className = `pill ${kind}`;
    fill(this.pill, words);
    const old = robot.up ? oldness(robot) : "";
    fill(this.gone, robot.away ? t("watch.gone") : old && t("watch.old", { old }));
    this.place.classList.toggle("stale", !robot.up || old !== "");
    this.tree.element.classList.toggle("stale", robot.away || !robot.isHeard);
    fill(this.title, task ? called(task) : robot.name);
    this.speech.show(robot);
    this.body.show(robot, this.running.textContent ? [...this.running.children].map((each) => each.textContent).join(", ") : "");
    this.offers.show(robot, task !== null);
    this.map.redraw();
    this.question.show(robot);
    this.talk?.show(robot);
    this.parts?.show(robot);
    this.log.update(robot.entries);
    this.showControls();
  }

  private showRun(run: Run | null): void {
    this.empty.hidden = run !== null;
    this.first.hidden = run !== null || !may(this.context.me, "editor");
    this.tree.element.hidden = run === null;
    if (run && run !== this.run) {
      this.chosen = -1;
      this.map.mark([]);
      if (run.id !== this.run?.id) this.tree.setNodes(this.withRules ? nodesOf(run) : withoutRules(nodesOf(run), run.root));
      else this.tree.setWords(nodesOf(run).map(({ label }, index) => [index, label] as const));
      this.tree.setStatuses(run.statuses.entries());
    }
    this.run = run;
    const leaves = run && this.robot.up ? running(run) : [];
    this.text.hidden = !run?.text;
    this.words.show(run?.text ?? "", pieces(leaves.map((node) => run?.places[node] ?? null), run?.places[this.chosen] ?? null));
    const words = leaves.slice(0, MOST_RUNNING).map((leaf) => run!.nodes[leaf]![2]);
    const shown = JSON.stringify([run?.id, leaves, words]);
    if (this.running.dataset["shown"] === shown) return;
    this.running.dataset["shown"] = shown;
    fill(this.running, ...words.map((each) => h("li", { dir: "auto" }, each)));
    if (this.follow.getAttribute("aria-pressed") === "true" && leaves.length) this.tree.bring(leaves[0]!);
  }

  /** The run whose house rules hold now. */
  private get ruled(): Run | null {
    const { run, rules, doing } = this.robot;
    return (doing.task ? run : rules) ?? run;
  }

  /** Shows the tree with the house rules, at one of them; again without them where it's shown already. */
  private showRule([node]: Rule): void {
    this.withRules = !(this.withRules && this.tree.selected === node);
    this.run = null;
    this.show();
    if (this.withRules) this.tree.select(node);
  }

  private showControls(): void {
    const paused = this.robot.state?.paused ?? false;
    if (paused || this.robot.away) this.voice.silence();
    const task = this.queue.underway;
    this.visitor.hidden = !may(this.context.me, "operator") || !this.robot.state?.visitors;
    const shown = JSON.stringify([paused, task?.id, this.robot.up]);
    if (!may(this.context.me, "operator") || shown === this.shownControls) return;
    this.shownControls = shown;
    const button = (key: Key, name: string, fields = {}): HTMLElement =>
      h("button", { type: "button", disabled: !this.robot.up, onclick: () => void this.act(name, fields) }, t(key));
    fill(
      this.controls,
      paused ? button("resume", "resume") : button("pause", "pause"),
      paused && button("step", "step"),
      task && button("cancel", "cancel", { task: task.id }),
    );
  }

  private async act(name: string, fields: Record<string, unknown>): Promise<void> {
    fill(this.problem);
    try {
      await command(this.context, name, fields);
    } catch (error) {
      fill(this.problem, (error as Error).message);
    }
  }

  private select(path: string): void {
    this.choose(this.run?.nodes.findIndex(([each]) => each === path) ?? -1, true);
  }

  /** What is said at a character. */
  private selectAt(at: number): void {
    const places = this.run?.places.map((place) => ({ start: place?.[0] ?? null, end: place?.[1] ?? null })) ?? [];
    this.choose(nodeAt(places, at), true);
  }

  private valuesOf(node: number): string[] {
    return Object.values(this.run?.nodes[node]?.[3] ?? {});
  }

  /** Shows a node in the text, too; with `inTree` in the tree. */
  private choose(node: number, inTree = false): void {
    if (node < 0) return;
    this.chosen = node;
    this.map.mark(this.valuesOf(node));
    if (inTree) this.tree.select(node);
    this.refresh();
  }
}
