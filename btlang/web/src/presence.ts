// Who else is here: the people on a robot behind a count, and who else has the open mission.
import { address } from "./address";
import { fill, h, openMenu } from "./dom";
import type { Link, OpenPage } from "./socket";
import { t, visible, type Key } from "./texts";

const SCREENS: Record<string, Key> = { robots: "robots", watch: "tab.watch", tasks: "tab.tasks", write: "tab.write", runs: "tab.runs" };

export class Presence {
  readonly button = h("button", { type: "button", class: "people", "aria-haspopup": "menu", hidden: true, onclick: () => this.open() });
  private others: OpenPage[] = [];
  private robot = "";
  private screen = "robots";
  private mission = "";
  private changing = false;
  private watchers = new Set<() => void>();

  constructor(
    private user: string,
    private link: () => Link,
  ) {}

  /** The page shows another screen. */
  look(robot: string, screen: string): void {
    [this.robot, this.screen] = [robot, screen];
    this.say();
    this.draw();
  }

  /** A mission is open, "" for none any more; `changing`: it isn't saved. */
  write(mission: string, changing: boolean): void {
    [this.mission, this.changing] = [mission, changing];
    this.say();
  }

  /** The other pages that are open now. */
  meet(others: OpenPage[]): void {
    this.others = others;
    this.draw();
    for (const watcher of this.watchers) watcher();
  }

  /** Until the function that it returns is called. */
  watch(watcher: () => void): () => void {
    this.watchers.add(watcher);
    return () => this.watchers.delete(watcher);
  }

  /** Who else has the mission of this page open, in words. */
  get company(): string {
    const here = this.others.filter(({ robot, mission }) => mission !== "" && mission === this.mission && robot === this.robot);
    const changing = new Map<string, boolean>();
    for (const each of here) changing.set(each.user, each.changing || (changing.get(each.user) ?? false));
    const sentence = (user: string, changes: boolean): string => {
      if (user === this.user) return t(changes ? "people.self_changing" : "people.self_open");
      return t(changes ? "people.changing" : "people.open", { user: visible(user) });
    };
    return [...changing].sort(([a], [b]) => a.localeCompare(b)).map(([user, changes]) => sentence(user, changes)).join(" ");
  }

  private say(): void {
    this.link().show({ robot: this.robot, screen: this.screen, mission: this.mission, changing: this.changing });
  }

  /** Other people on the robot of this page, or on all where it shows none; each once, at what they change. */
  private get people(): OpenPage[] {
    const found = new Map<string, OpenPage>();
    for (const each of this.others) {
      const here = each.user !== this.user && (!this.robot || each.robot === this.robot);
      if (here && (each.changing || !found.has(each.user))) found.set(each.user, each);
    }
    return [...found.values()].sort((a, b) => a.user.localeCompare(b.user));
  }

  private draw(): void {
    const { people } = this;
    this.button.hidden = !people.length;
    const label = t(people.length === 1 ? "people.one" : "people.count", { count: people.length, user: visible(people[0]?.user ?? "") });
    this.button.setAttribute("aria-label", label);
    this.button.title = people.map(({ user }) => visible(user)).join(", ");
    fill(this.button, h("span", { "aria-hidden": "true" }, people.length));
  }

  /** Each name leads to what this person looks at. */
  private open(): void {
    const { left, bottom } = this.button.getBoundingClientRect();
    openMenu(left, bottom + 4, t("people"), this.people.map((each) => ({
      label: visible(`${each.user} · ${this.what(each)}`),
      run: () => (location.hash = this.where(each)),
    })));
  }

  private what({ screen, mission, changing }: OpenPage): string {
    if (!mission) return t(SCREENS[screen] ?? "robots");
    return t(changing ? "people.changes" : "people.reads", { mission });
  }

  private where({ robot, screen, mission }: OpenPage): string {
    if (screen === "write" || screen === "runs") return mission ? address(screen, mission) : address(screen);
    return screen === "tasks" ? address("robots", robot, "tasks") : robot ? address("robots", robot) : address("robots");
  }
}
