// The text of a mission: messages under the words, their fixes, completion, hover, and one undo for text and tree.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap, type CompletionContext, type CompletionResult } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab, isolateHistory, redo, undo } from "@codemirror/commands";
import { bracketMatching, indentUnit } from "@codemirror/language";
import { forEachDiagnostic, linter, lintGutter, lintKeymap, setDiagnostics, type Action, type Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { Compartment, EditorState, StateEffect, StateField, type Extension } from "@codemirror/state";
import { Decoration, drawSelection, EditorView, highlightActiveLine, highlightSpecialChars, hoverTooltip, keymap, lineNumbers, type DecorationSet, type Tooltip } from "@codemirror/view";

import { h } from "../dom";
import { t } from "../texts";
import type { Piece } from "../watch/words";
import type { Change, Message, Reader } from "./understood";

/** `changed` is called after each change of the text, `moved` when the caret goes elsewhere. */
export interface EditorOptions {
  reader: Pick<Reader, "service">;
  readOnly: boolean;
  changed: (text: string) => void;
  moved: (at: number) => void;
  keys: { key: string; run: () => void }[];
}

const [LEAST, MOST] = [150, 500]; // milliseconds until what was written gets its colours

/** A part of the text, and as what its words are read; see `tokens` in btlang/editing/help.py. */
interface Colours {
  from: number;
  to: number;
  tokens: { start: number; end: number; kind: string }[];
}

type Kind = "command" | "condition" | "name" | "value" | "connective";

const colour = StateEffect.define<Colours>();
const coloured = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(before, transaction) {
    let now = before.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(colour)) continue;
      const { from, to, tokens } = effect.value;
      const add = tokens.map(({ start, end, kind }) => Decoration.mark({ class: `token-${kind}` }).range(start, end));
      now = now.update({ filterFrom: from, filterTo: to, filter: () => false, add });
    }
    return now;
  },
  provide: (field) => EditorView.decorations.from(field),
});
const mark = StateEffect.define<{ from: number; to: number } | null>();
const lights = StateEffect.define<readonly Piece[]>();
const marked = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(before, transaction) {
    let now = before.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (effect.is(lights)) now = Decoration.set(effect.value.filter(([, end]) => end <= transaction.newDoc.length).map(([start, end, kind]) => Decoration.mark({ class: kind }).range(start, end)));
      if (effect.is(mark)) now = effect.value && effect.value.from < effect.value.to ? Decoration.set(Decoration.mark({ class: "chosen" }).range(effect.value.from, effect.value.to)) : Decoration.none;
    }
    return now;
  },
  provide: (field) => EditorView.decorations.from(field),
});

const colours = EditorView.theme({
  "&": { height: "100%", backgroundColor: "var(--surface)", color: "var(--text)", fontSize: "0.9375rem" },
  "&.cm-focused": { outline: "2px solid var(--accent)", outlineOffset: "-2px" },
  ".cm-scroller": { fontFamily: 'ui-monospace, "SF Mono", Consolas, monospace', lineHeight: "1.55" },
  ".cm-content": { caretColor: "var(--text)", padding: "0.5rem 0" },
  ".cm-gutters": { backgroundColor: "var(--surface)", color: "var(--muted)", border: "none" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--quiet-ground) 55%, transparent)" },
  ".cm-cursor": { borderLeftColor: "var(--text)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "color-mix(in srgb, var(--accent) 28%, transparent)" },
  ".token-word": { color: "var(--accent)" },
  ".token-condition": { color: "var(--person)" },
  ".token-name": { color: "var(--success)", fontWeight: "600" },
  ".token-text, .token-number": { color: "var(--skipped)" },
  ".token-comment": { color: "var(--muted)", fontStyle: "italic" },
  ".chosen": { backgroundColor: "var(--mark)", borderRadius: "2px" },
  ".runs": { backgroundColor: "var(--now)", borderRadius: "2px" },
  ".runs.chosen": { boxShadow: "inset 0 0 0 2px var(--mark)" },
  ".cm-tooltip": { backgroundColor: "var(--raised)", color: "var(--text)", border: "1px solid var(--line)", borderRadius: "6px", boxShadow: "0 4px 16px rgb(0 0 0 / 18%)", maxWidth: "min(34rem, 90vw)" },
  ".cm-tooltip .about": { padding: "0.5rem 0.75rem", display: "grid", gap: "0.25rem" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--on-accent)" },
  ".cm-diagnostic": { padding: "0.5rem 0.75rem", whiteSpace: "pre-wrap" },
  ".cm-diagnosticAction": { backgroundColor: "var(--accent)", color: "var(--on-accent)", padding: "0.15rem 0.6rem", borderRadius: "4px", margin: "0.35rem 0.35rem 0 0" },
  ".cm-panels": { backgroundColor: "var(--raised)", color: "var(--text)" },
  ".cm-matchingBracket": { backgroundColor: "var(--quiet-ground) !important" },
});

export class Editor {
  readonly view: EditorView;
  private options: EditorOptions;
  private readOnly = new Compartment();
  private silent = false;
  private timer = 0;
  private pause = LEAST;

  constructor(text: string, label: string, options: EditorOptions) {
    this.options = options;
    this.view = new EditorView({
      state: EditorState.create({
        doc: text,
        extensions: [
          mayStyle(),
          EditorState.phrases.of(phrases()),
          EditorView.contentAttributes.of({ "aria-label": label, tabindex: "0", lang: "en", dir: "auto", spellcheck: "false", autocapitalize: "off" }),
          EditorView.perLineTextDirection.of(true),
          this.readOnly.of(EditorState.readOnly.of(options.readOnly)),
          keymap.of([
            ...options.keys.map(({ key, run }) => ({ key, run: () => (run(), true), preventDefault: true })),
            { key: "Ctrl-.", mac: "Cmd-.", run: () => this.fix() },
            ...closeBracketsKeymap, ...completionKeymap, ...lintKeymap, ...searchKeymap, ...historyKeymap, ...defaultKeymap, indentWithTab,
          ]),
          lineNumbers(), highlightSpecialChars(), lintGutter(), linter(null), history(), drawSelection(), bracketMatching(), closeBrackets(), highlightActiveLine(), highlightSelectionMatches(),
          indentUnit.of("  "), EditorView.lineWrapping, coloured, marked, colours,
          autocompletion({ override: [(context) => this.complete(context)] }),
          hoverTooltip((_, at) => this.about(at)),
          EditorView.domEventHandlers({ beforeinput: (event, view) => replaceSelected(event, view) }),
          EditorView.updateListener.of((update) => {
            if (update.docChanged) options.changed(this.text);
            if (update.docChanged || update.viewportChanged) this.colourSoon();
            if (update.selectionSet && !update.docChanged && !this.silent) options.moved(update.state.selection.main.head);
          }),
        ],
      }),
    });
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  /** Puts another text in, which can be undone. */
  set text(text: string) {
    this.apply([smallest(this.text, text)]);
  }

  /** Changes of the text as one step of undo. `select` are characters of the new text. */
  apply(changes: Change[], select?: [number, number]): void {
    this.view.dispatch({
      changes: changes.map(({ start, end, text }) => ({ from: start, to: end, insert: text })),
      annotations: isolateHistory.of("full"),
      ...(select ? { effects: mark.of({ from: select[0], to: select[1] }), scrollIntoView: true } : {}),
    });
  }

  undo(): void {
    undo(this.view);
  }

  redo(): void {
    redo(this.view);
  }

  /** Marks characters, and brings them into view. */
  show(start: number, end: number): void {
    this.silent = true;
    this.view.dispatch({ selection: { anchor: start }, effects: [mark.of({ from: start, to: end }), EditorView.scrollIntoView(start, { y: "nearest", yMargin: 40 })] });
    this.silent = false;
  }

  /** Marks some pieces, without going there. */
  light(marked: readonly Piece[]): void {
    this.view.dispatch({ effects: lights.of(marked) });
  }

  /** Puts the caret there. */
  go(at: number): void {
    this.view.dispatch({ selection: { anchor: at }, scrollIntoView: true });
    this.view.focus();
  }

  /** Puts messages under the words of the text as it is now. */
  tell(messages: Message[]): void {
    const length = this.view.state.doc.length;
    const found = messages.map((each): Diagnostic => {
      const from = Math.min(each.start, length);
      return {
        from,
        to: Math.max(Math.min(each.end, length), from),
        severity: each.severity === "note" ? "info" : each.severity,
        message: [each.message, each.hint].filter(Boolean).join("\n"),
        source: each.code,
        actions: this.fixes(each, from),
      };
    });
    this.view.dispatch(setDiagnostics(this.view.state, found));
  }

  /** The number of the line of a character, from 1. */
  lineAt(at: number): number {
    return this.view.state.doc.lineAt(Math.min(at, this.view.state.doc.length)).number;
  }

  lock(locked: boolean): void {
    this.view.dispatch({ effects: this.readOnly.reconfigure(EditorState.readOnly.of(locked)) });
  }

  close(): void {
    clearTimeout(this.timer);
    this.view.destroy();
  }

  /** Colours what is seen, once nobody types; of a long text later, since its messages come first. */
  private colourSoon(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.colour(), this.pause);
  }

  private async colour(): Promise<void> {
    const { text } = this;
    const { from, to } = this.view.viewport;
    const began = performance.now();
    const { tokens } = await this.options.reader.service("tokens", text, { at: from, to });
    this.pause = Math.min(Math.max(LEAST, 2 * (performance.now() - began)), MOST);
    if (tokens && text === this.text) this.view.dispatch({ effects: colour.of({ from, to, tokens }) });
  }

  /** Does what the first message at the caret offers. */
  fix(): boolean {
    const at = this.view.state.selection.main.head;
    const line = this.view.state.doc.lineAt(at);
    let found: [Diagnostic, number, number] | null = null;
    forEachDiagnostic(this.view.state, (each, from, to) => {
      const here = from <= line.to && to >= line.from && each.actions?.length;
      if (here && (!found || Math.abs(from - at) < Math.abs(found[1] - at))) found = [each, from, to];
    });
    if (!found) return false;
    const [diagnostic, from, to] = found as [Diagnostic, number, number];
    diagnostic.actions![0]!.apply(this.view, from, to);
    return true;
  }

  /** `told` is where the message began. The text before it may have changed since then, and what it is about, too. */
  fixes(message: Message, told = message.start): Action[] {
    const { doc } = this.view.state;
    const changes = [...(message.readings.length ? message.readings : message.fix ? [message.fix] : [])];
    return changes.map((change) => ({
      name: t("write.fix", { words: change.text.length > 60 ? `${change.text.slice(0, 60)}…` : change.text }),
      apply: (view, from) => {
        const [start, end] = [change.start + from - told, change.end + from - told];
        const same = view.state.sliceDoc(Math.max(start, 0), end) === doc.sliceString(change.start, change.end);
        if (same) this.apply([{ start, end, text: change.text }]);
      },
    }));
  }

  private async complete(context: CompletionContext): Promise<CompletionResult | null> {
    const word = context.matchBefore(/[\p{L}\p{N}'-]*/u);
    if (!context.explicit && !word?.text && !/[ :,]$/.test(context.state.sliceDoc(Math.max(0, context.pos - 1), context.pos))) return null;
    const text = context.state.sliceDoc();
    const answer = await this.options.reader.service("complete", text, { at: context.pos });
    const offers = (answer.completions ?? []) as { text: string; start: number; kind: Kind; help: string }[];
    if (!offers.length || context.aborted || !this.view.hasFocus) return null;
    const from = Math.min(...offers.map(({ start }) => start));
    return {
      from,
      filter: false, // they come in their order
      getMatch: (option) => (option.label.toLowerCase().startsWith(context.state.sliceDoc(from, context.pos).toLowerCase()) ? [0, context.pos - from] : []),
      options: offers.map(({ text: words, start, kind, help }) => ({ label: text.slice(from, start) + words, detail: t(`offer.${kind}`), ...(help ? { info: help } : {}) })),
    };
  }

  private async about(at: number): Promise<Tooltip | null> {
    const { found } = await this.options.reader.service("hover", this.text, { at });
    if (!found) return null;
    const { words, help, example } = found as { words: string; help: string; example: string };
    const lines = [words && h("strong", {}, words), help && h("span", {}, help), example && h("code", {}, example)];
    return { pos: found.start, end: found.end, above: true, create: () => ({ dom: h("div", { class: "about", dir: "auto", lang: "en" }, ...lines) }) };
  }
}

/** Puts what is typed in the place of what is selected. Chromium would keep its colours in a style of the element, which
 *  the page's policy refuses.
 */
function replaceSelected({ inputType, data }: InputEvent, view: EditorView): boolean {
  const { from, to, empty } = view.state.selection.main;
  if (inputType !== "insertText" || !data || empty || view.composing) return false;
  const insert = () => view.state.update(view.state.replaceSelection(data), { userEvent: "input.type", scrollIntoView: true });
  if (!view.state.facet(EditorView.inputHandler).some((handle) => handle(view, from, to, data, insert))) view.dispatch(insert());
  return true;
}

/** The page's policy lets only what has its nonce bring styles. */
export function mayStyle(): Extension {
  return EditorView.cspNonce.of(document.querySelector<HTMLScriptElement>("script[nonce]")?.nonce ?? "");
}

/** The smallest change that makes one text of another. */
export function smallest(before: string, after: string): Change {
  const most = Math.min(before.length, after.length);
  let start = 0;
  while (start < most && before[start] === after[start]) start++;
  let same = 0;
  while (same < most - start && before[before.length - 1 - same] === after[after.length - 1 - same]) same++;
  return { start, end: before.length - same, text: after.slice(start, after.length - same) };
}

/** A text with changes, which are in the order of the text. */
export function changed(before: string, changes: Change[]): string {
  return changes.reduceRight((text, { start, end, text: words }) => text.slice(0, start) + words + text.slice(end), before);
}

/** The editor's own words, where the language of the page has others. */
function phrases(): Record<string, string> {
  return { Find: t("cm.find"), Replace: t("cm.replace"), next: t("cm.next"), previous: t("cm.previous"), all: t("cm.all"), close: t("cm.close"), replace: t("cm.replace"), "replace all": t("cm.replace_all"), "match case": t("cm.case"), regexp: t("cm.regexp"), "by word": t("cm.word"), Diagnostics: t("cm.problems"), "No diagnostics": t("write.fine") };
}
