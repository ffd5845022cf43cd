// The command palette: screens, robots, missions, the emergency stop, themes and languages, found by a few letters.
import { address } from "../address";
import { may, type Me } from "../api";
import { fill, h } from "../dom";
import { addStyle } from "../late_style";
import { loadMore, more } from "../more_texts";
import { libraryOf } from "../tasks/library";
import { language, languages, setLanguage, t, visible } from "../texts";
import { setTheme, theme, THEMES } from "../theme";
import { show } from "../write/ask";
import style from "./palette.css" with { type: "text" };

/** `stopped` are the robots that `stop` stops, "" for one whose name isn't known; `again` draws the page once more. */
export interface PaletteContext {
  me: Me;
  robot: string;
  robots: string[];
  stopped: string[];
  stop: () => void;
  again: () => void;
  logOut: () => void;
}

interface Command {
  label: string;
  group: string;
  run: () => void;
}

let dialog: HTMLDialogElement | null = null;

/** Opens the palette, or closes it if it's open. */
export async function togglePalette(context: PaletteContext): Promise<void> {
  await loadMore();
  if (dialog?.isConnected) return dialog.close(); // one that isn't went with the page of a session that ended
  addStyle(style);
  new Palette(commandsOf(context), context);
}

class Palette {
  private input = h("input", {
    type: "text", role: "combobox", "aria-expanded": "true", "aria-controls": "commands", "aria-autocomplete": "list",
    "aria-label": more("commands.search"), placeholder: more("commands.search"), autocomplete: "off", dir: "auto",
  });
  private list = h("ul", { class: "commands", id: "commands", role: "listbox", "aria-label": t("commands") });
  private status = h("p", { class: "commands-none", role: "status" });
  private found: Command[] = [];
  private at = 0;

  constructor(
    private commands: Command[],
    { robot, me }: PaletteContext,
  ) {
    this.input.addEventListener("input", () => this.filter());
    this.input.addEventListener("keydown", (event) => this.press(event));
    const shown = show(t("commands"), this.input, this.list, this.status);
    dialog = shown;
    shown.addEventListener("close", () => (dialog = null));
    this.filter();
    this.input.focus();
    if (!me.screen.length) void libraryOf(robot).then((missions) => this.add(missions.map(({ name }) => name)), () => undefined);
  }

  /** The missions come after the screens and the robots, also while somebody writes. */
  private add(missions: string[]): void {
    const chosen = this.found[this.at];
    const made = missions.map((name) => command(name.replaceAll("_", " "), more("commands.missions"), () => go("write", name)));
    const page = this.commands.findIndex(({ group }) => group === more("commands.page"));
    this.commands.splice(page, 0, ...made);
    this.filter();
    if (chosen) this.choose(Math.max(0, this.found.indexOf(chosen)));
  }

  private filter(): void {
    const query = plain(this.input.value).trim();
    const ranked = this.commands.map((each) => ({ each, rank: rank(plain(each.label), query) }));
    this.found = ranked.filter(({ rank }) => rank < Infinity).sort((a, b) => a.rank - b.rank).map(({ each }) => each);
    fill(this.list, ...this.found.map((each, index) => h(
      "li", { role: "option", id: `command-${index}`, onclick: () => this.run(index) },
      h("span", { dir: "auto" }, each.label), h("small", {}, each.group),
    )));
    fill(this.status, this.found.length ? h("span", { class: "aside" }, more("commands.count", { count: this.found.length })) : more("commands.none"));
    this.choose(0);
  }

  private choose(at: number): void {
    this.at = at;
    const options = [...this.list.children];
    options.forEach((each, index) => each.setAttribute("aria-selected", String(index === at)));
    options[at]?.scrollIntoView({ block: "nearest" });
    if (options[at]) this.input.setAttribute("aria-activedescendant", options[at].id);
    else this.input.removeAttribute("aria-activedescendant");
  }

  private press(event: KeyboardEvent): void {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (event.key === "Enter" && !event.isComposing) {
      event.preventDefault();
      this.run(this.at);
    } else if (step && this.found.length) {
      event.preventDefault();
      this.choose((this.at + step + this.found.length) % this.found.length);
    }
  }

  private run(index: number): void {
    const chosen = this.found[index];
    if (!chosen) return;
    dialog?.close();
    chosen.run();
  }
}

function commandsOf({ me, robot, robots, stopped, stop, again, logOut }: PaletteContext): Command[] {
  const [screens, page] = [more("commands.screens"), more("commands.page")];
  const only = me.screen.length > 0; // of `btc edit` and `btc watch`, which have one screen and nobody to log out
  const ofRobot = robot && !only ? [
    command(t("tab.watch"), screens, () => go("robots", robot)),
    command(t("tab.tasks"), screens, () => go("robots", robot, "tasks")),
  ] : [];
  const others = only ? [] : [
    command(t("tab.write"), screens, () => go("write")),
    command(t("tab.runs"), screens, () => go("runs")),
    command(t("robots"), screens, () => go("robots")),
    may(me, "administrator") && command(t("tab.accounts"), screens, () => go("accounts")),
    ...robots.map((name) => command(visible(name), more("commands.robots"), () => go("robots", name))),
  ];
  const stops = me.screen[0] === "write" || me.screen[0] === "runs" ? [] : [
    command(more("commands.stop", { robots: stopped.map((name) => visible(name) || t("robot.the")).join(", ") }), more("commands.robot"), stop),
  ];
  return [
    ...ofRobot, ...others,
    ...THEMES.filter((name) => name !== theme()).map((name) => command(more("commands.theme", { name: t(`theme.${name}`) }), page, () => setTheme(name))),
    ...languages.filter(([name]) => name !== language()).map(([name, label]) => command(more("commands.language", { name: label }), page, () => { setLanguage(name); again(); })),
    !only && command(t("logout"), page, logOut),
    ...stops, // last: Enter in an empty palette must not stop a robot
  ].filter((each) => each !== false);
}

function command(label: string, group: string, run: () => void): Command {
  return { label, group, run };
}

function go(...parts: string[]): void {
  location.hash = address(...parts);
}

/** A text without accents and capitals. */
function plain(text: string): string {
  return text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();
}

/** How well a label fits: it begins with the query, a word does, it has all words of it; Infinity if it doesn't. */
function rank(label: string, query: string): number {
  if (label.startsWith(query)) return 0;
  if (label.split(/[\s:,]+/).some((word) => word.startsWith(query))) return 1;
  return query.split(/\s+/).every((word) => label.includes(word)) ? 2 : Infinity;
}
