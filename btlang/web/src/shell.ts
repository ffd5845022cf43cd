// The frame around every screen: robots, tabs, who is logged in, and the emergency stop.
import { address } from "./address";
import { logOut, may, request, type Me } from "./api";
import { fill, h, openMenu } from "./dom";
import { Fleet } from "./fleet";
import { Presence } from "./presence";
import { openRobots } from "./robots";
import { Link } from "./socket";
import { EmergencyStop } from "./stop";
import { language, languages, setLanguage, t } from "./texts";
import { setTheme, theme, THEMES } from "./theme";
import type { Open, View } from "./view";

const ALL = ["tree", "tasks", "events", "robot", "map", "components", "body"];
const TABS = { watch: "tab.watch", tasks: "tab.tasks", write: "tab.write", runs: "tab.runs" } as const;
const LATEST = "btlang.robot";
type Tab = keyof typeof TABS;
type Screen = Tab | "accounts";
const IS_MAC = /Mac|iP/.test(navigator.platform);
const OPENERS: Record<Screen, () => Promise<Open>> = {
  watch: async () => (await import("./watch/watch")).openWatch,
  tasks: async () => (await import("./tasks/tasks")).openTasks,
  write: async () => (await import("./write/write")).openWrite,
  runs: async () => (await import("./look_back/look_back")).openLookBack,
  accounts: async () => (await import("./accounts/accounts")).accountsOpener(),
};

/** `again` starts the page once more: for somebody else, or in another language. */
export class Shell {
  private fleet = new Fleet();
  private link: Link;
  private stop: EmergencyStop;
  private presence: Presence;
  private robot = "";
  private view: View | null = null;
  private shown = 0;
  private heard = "";
  private tabs = h("nav", { class: "tabs", "aria-label": t("tabs") });
  private place = h("a", { class: "robot", href: address("robots"), dir: "auto" });
  private main = h("main", { tabindex: -1 });
  private cut = h("p", { class: "cut", role: "status" });
  private onRoute = () => void this.route();
  private onKey = (event: KeyboardEvent) => {
    if (event.key.toLowerCase() !== "k" || event.shiftKey || event.altKey || !(IS_MAC ? event.metaKey : event.ctrlKey)) return;
    event.preventDefault();
    void this.openPalette();
  };

  constructor(
    private me: Me,
    private again: () => void,
  ) {
    if (me.screen[0]) document.body.dataset["only"] = me.screen[0];
    this.presence = new Presence(me.user, () => this.link);
    this.link = new Link(
      (news) => this.fleet.take(news),
      (online) => this.connected(online),
      () => this.leave(),
      (others) => this.presence.meet(others),
    );
    this.stop = new EmergencyStop(this.fleet, this.link, me, () => this.stopped());
    const user = h("button", { type: "button", class: "user", "aria-haspopup": "menu", title: t(`role.${me.role}`) }, h("span", { dir: "auto" }, me.user));
    user.addEventListener("click", () => this.openUserMenu(user));
    const header = h("header", {}, this.place, this.tabs, this.presence.button, user, this.stop.button);
    fill(document.body, h("a", { class: "skip", href: "#main", onclick: (event: Event) => { event.preventDefault(); this.main.focus(); } }, t("skip")), header, this.cut, this.stop.banner, this.main);
    addEventListener("hashchange", this.onRoute);
    addEventListener("keydown", this.onKey, { capture: true });
    void request("GET", "/api/robots").then(({ robots }) => (robots as { name: string }[]).forEach(({ name }) => this.fleet.get(name)), () => undefined).then(() => this.route());
  }

  private close(): void {
    removeEventListener("hashchange", this.onRoute);
    removeEventListener("keydown", this.onKey, { capture: true });
    this.view?.close();
    this.stop.close();
    this.link.close();
  }

  private leave(): void {
    this.close();
    this.again();
  }

  private connected(online: boolean): void {
    fill(this.cut, online ? "" : t("offline"));
    if (!online) this.fleet.disconnect();
  }

  private stopped(): string[] {
    if (this.robot) return [this.robot];
    const known = [...this.fleet.robots.keys()];
    return known.length ? known : [""];
  }

  /** Addresses: #/robots, #/robots/NAME, #/robots/NAME/tasks, #/write/NAME, #/runs/..., #/accounts */
  private async route(): Promise<void> {
    const [first = "robots", ...rest] = location.hash.slice(2).split("/").filter(Boolean).map(decoded);
    if (first === "robots") this.robot = rest.shift() ?? "";
    else this.robot ||= sessionStorage.getItem(LATEST) || ([...this.fleet.robots.keys()][0] ?? "");
    sessionStorage.setItem(LATEST, this.robot);
    const accounts = first === "accounts" && this.administers;
    const tab: Screen | null = accounts || first === "write" || first === "runs" ? (first as Screen) : !this.robot ? null : rest[0] === "tasks" ? "tasks" : "watch";
    const shown = tab === "accounts" ? null : tab; // it isn't about a robot, and others aren't told of it
    this.listen(shown);
    this.showTabs(shown);
    this.stop.show();
    const turn = ++this.shown;
    const open = tab ? await OPENERS[tab]() : openRobots;
    if (turn !== this.shown) return;
    this.view?.close();
    this.presence.look(this.robot, shown ?? "robots");
    this.view = open({ me: this.me, fleet: this.fleet, link: this.link, presence: this.presence, robot: this.robot, path: rest });
    document.title = [this.robot, tab ? t(`tab.${tab}`) : t("robots"), "btlang"].filter(Boolean).join(" · ");
    fill(this.main, this.view.element);
  }

  private listen(tab: Tab | null): void {
    const wanted = tab ? { topics: ALL, rate: 20, language: language(), ...(this.robot ? { robots: [this.robot] } : {}) } : { topics: ["robot", "tasks", "map"], rate: 2 };
    if (this.heard === JSON.stringify(wanted)) return;
    this.heard = JSON.stringify(wanted);
    this.link.subscribe(wanted);
  }

  private showTabs(current: Tab | null): void {
    fill(this.place, this.robot || t("robots"));
    this.place.setAttribute("aria-label", this.robot ? t("robots.choose", { robot: this.robot }) : t("robots"));
    const addresses: Record<Tab, string> = {
      watch: address("robots", this.robot),
      tasks: address("robots", this.robot, "tasks"),
      write: address("write"),
      runs: address("runs"),
    };
    const tabs = (Object.keys(TABS) as Tab[]).filter((tab) => this.robot || tab === "write" || tab === "runs");
    fill(this.tabs, ...tabs.map((tab) => h("a", { href: addresses[tab], "aria-current": tab === current && "page" }, t(TABS[tab]))));
  }

  private openUserMenu(button: HTMLElement): void {
    const { left, bottom } = button.getBoundingClientRect();
    openMenu(left, bottom + 4, this.me.user, [
      { label: `${t("commands")} · ${IS_MAC ? "⌘" : "Ctrl+"}K`, run: () => void this.openPalette() },
      ...(this.administers ? [{ label: t("tab.accounts"), run: () => (location.hash = address("accounts")) }] : []),
      ...languages.filter(([name]) => name !== language()).map(([name, label]) => ({ label, run: () => { setLanguage(name); this.leave(); } })),
      ...THEMES.filter((name) => name !== theme()).map((name) => ({ label: t(`theme.${name}`), run: () => setTheme(name) })),
      ...(this.me.screen.length ? [] : [{ label: t("logout"), run: () => this.logOut() }]),
    ]);
  }

  private get administers(): boolean {
    return may(this.me, "administrator") && !this.me.screen.length;
  }

  private logOut(): void {
    void logOut().finally(() => this.leave());
  }

  private async openPalette(): Promise<void> {
    const { togglePalette } = await import("./commands/palette");
    await togglePalette({
      me: this.me, robot: this.robot, robots: [...this.fleet.robots.keys()], stopped: this.stopped(),
      stop: () => this.stop.press(), again: () => this.leave(), logOut: () => this.logOut(),
    });
  }
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}
