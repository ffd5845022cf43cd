// The tests of a mission: written beside it, run on the server, with what did not hold in the words of both.
import { fill, h } from "../dom";
import { addStyle } from "../late_style";
import type { Film } from "../look_back/player";
import { t } from "../texts";
import { Editor, smallest } from "./editor";
import { SavedMission } from "./saved_mission";
import { play } from "./play";
import type { Store } from "./store";
import style from "./tests.css" with { type: "text" };
import { problemOf, type Message, type Reader } from "./understood";

/** See btlang/testing/trial.py; null for a test that there was no time left for. */
interface Result {
  name: string;
  line: number;
  passed: boolean | null;
  seconds: number;
  problem?: string;
  at?: number;
  start?: number | null;
  end?: number | null;
  film?: Film | null;
}

interface Problem {
  line: number;
  code: string;
  message: string;
}

/** What the tests need of the mission that they belong to: its name, its text, and to show characters of that text. */
export interface Tested {
  name: string;
  text: () => string;
  show: (start: number, end: number) => void;
}

export class Tests {
  readonly element: HTMLElement;
  private state = h("span", { class: "state", role: "status" });
  private problem = h("p", { class: "problem", role: "alert" });
  private results = h("ol", { class: "results", "aria-live": "polite" });
  private editor: Editor;
  private saved: SavedMission;
  private loaded = false;
  private example: string; // what somebody begins with who has no tests

  constructor(
    store: Store,
    private mission: Tested,
    private reader: Reader,
    private mayWrite: boolean,
  ) {
    this.example = `test "it works":\n  run "${mission.name.replace(/"/g, "")}"\n  finally the mission succeeds\n`;
    this.editor = new Editor("", t("tests.text"), {
      reader: { service: async () => ({}) }, // what missions are asked about, tests aren't
      readOnly: true,
      changed: () => this.saved.changed(),
      moved: () => undefined,
      keys: [
        { key: "Mod-s", run: () => void this.keep() },
        { key: "Mod-Enter", run: () => void this.run() },
      ],
    });
    this.saved = new SavedMission(store, this.editor, { told: () => this.tell(), failed: (problem) => this.fail(problem) });
    const tools = h(
      "div",
      { class: "doing" },
      h("h2", {}, t("tests")),
      this.state,
      h("div", { class: "controls" }, h("button", { type: "button", class: "primary", title: "Ctrl+Enter", onclick: () => void this.run() }, t("tests.run")), mayWrite && h("button", { type: "button", title: "Ctrl+S", onclick: () => void this.keep() }, t("tests.keep"))),
    );
    addStyle(style);
    this.element = h("section", { class: "card tests", hidden: true, "aria-label": t("tests") }, tools, h("div", { class: "halves" }, h("div", { class: "text" }, this.editor.view.dom), h("div", { class: "found", tabindex: 0, role: "region", "aria-label": t("tests.results") }, this.problem, this.results)));
  }

  /** Shows or hides them; whether they are shown. */
  toggle(): boolean {
    this.element.hidden = !this.element.hidden;
    if (this.element.hidden) return false;
    if (!this.loaded) void this.load();
    this.element.scrollIntoView({ block: "nearest" });
    return true;
  }

  close(): void {
    this.saved.keepDraft();
    this.editor.close();
  }

  private async load(): Promise<void> {
    try {
      await this.saved.load();
    } catch (error) {
      return this.fail((error as Error).message);
    }
    const { draft, kept } = this.saved;
    kept.text ||= this.example;
    const before = draft.read();
    this.editor.apply([smallest("", before?.text ?? kept.text)]);
    if (before) kept.revision = before.revision;
    this.editor.lock(!this.mayWrite);
    this.loaded = true;
    fill(this.results, h("li", { class: "empty" }, t("tests.none")));
    this.tell();
  }

  private async keep(): Promise<void> {
    if (!this.mayWrite || !this.loaded) return;
    fill(this.state, t("write.saving"));
    await this.saved.save();
  }

  private tell(): void {
    if (this.loaded) fill(this.state, this.saved.state);
  }

  private fail(problem: string): void {
    fill(this.problem, problem);
  }

  private async run(): Promise<void> {
    if (!this.loaded) return;
    const [mission, tests] = [this.mission.text(), this.editor.text];
    fill(this.state, t("tests.running"));
    this.fail("");
    const answer = await this.reader.service("test", mission, { tests, called: this.mission.name });
    this.tell();
    if (!answer.ok) {
      fill(this.results);
      return this.fail([t("tests.mission"), problemOf(answer)].join(" "));
    }
    if (this.editor.text !== tests) return this.fail(t("write.changed_meanwhile"));
    const problems = answer.problems as Problem[];
    const results = answer.results as Result[];
    const broken = results.filter(({ at }) => at).map(({ at, problem }): Problem => ({ line: at!, code: "", message: problem ?? "" }));
    this.editor.tell([...problems, ...broken].filter(({ line }) => line > 0).map((each) => this.message(each)));
    fill(this.results, ...problems.map((each) => this.asProblem(each)), ...results.map((each) => this.asResult(each)));
    if (results.length) this.results.prepend(h("li", { class: "sum" }, t("tests.sum", { passed: results.filter(({ passed }) => passed).length, all: results.length })));
  }

  private asProblem({ line, code, message }: Problem): HTMLElement {
    return h("li", { class: "bad" }, h("button", { type: "button", class: "plain", onclick: () => this.go(line) }, h("b", {}, code), " ", h("span", {}, message)));
  }

  private asResult(result: Result): HTMLElement {
    const { name, line, passed, seconds, problem, at, start, end, film } = result;
    const kind = passed === null ? "quiet" : passed ? "good" : "bad";
    const [first, ...rest] = (problem ?? "").split("\n").map((each) => each.replace(/^.*?(\.txt|tests):\d+: /, ""));
    return h(
      "li",
      { class: kind },
      h("span", { class: `pill ${kind}` }, t(passed === null ? "tests.late" : passed ? "tests.passed" : "tests.failed")),
      h("button", { type: "button", class: "plain name", dir: "auto", onclick: () => this.go(at || line) }, name),
      h("span", { class: "seconds" }, passed === null ? "" : t("tests.seconds", { seconds: seconds.toFixed(1) })),
      problem && h("p", { class: "why", lang: "en" }, h("strong", {}, first ?? ""), ...rest.flatMap((each) => [h("br"), each.trim()])),
      problem &&
        h(
          "div",
          { class: "controls" },
          start != null && end != null && h("button", { type: "button", onclick: () => this.mission.show(start, end) }, t("tests.words")),
          film && h("button", { type: "button", onclick: () => play(name, film) }, t("runs.replay")),
        ),
    );
  }

  private go(line: number): void {
    if (line > 0) this.editor.go(this.placeOf(line).start);
  }

  private message({ line, code, message }: Problem): Message {
    return { code, message, severity: "error", hint: "", ...this.placeOf(line), fix: null, readings: [] };
  }

  /** The words of a line. */
  private placeOf(line: number): { start: number; end: number } {
    const { doc } = this.editor.view.state;
    const found = doc.line(Math.min(line, doc.lines));
    return { start: found.from + found.text.search(/\S|$/), end: found.to };
  }
}
