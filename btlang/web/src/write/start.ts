// What an empty mission shows: three missions to begin with, and the map of what they name.
import { fill, h } from "../dom";
import { t } from "../texts";
import type { Context } from "../view";
import { MapView } from "../watch/map";

const MOST = 3;

export class Start {
  readonly element = h("div", { class: "start", hidden: true });
  private map: MapView;
  private unwatch: () => void;
  private made = false;

  /** `service` asks about a text; `take` gets the mission that somebody chose. */
  constructor(
    private context: Context,
    private service: (kind: string, text: string) => Promise<any>,
    private take: (text: string) => void,
  ) {
    this.map = new MapView(() => context.fleet.get(context.robot));
    this.unwatch = context.fleet.watch((robot, kind) => {
      if (robot.name !== context.robot || (kind !== "map" && kind !== "robot")) return;
      if (kind === "map" && !this.element.hidden && !this.made) void this.make();
      this.map.redraw();
    });
  }

  show(shown: boolean): void {
    this.element.hidden = !shown;
    if (shown && !this.made) void this.make();
  }

  close(): void {
    this.unwatch();
    this.map.close();
  }

  /** Those of some missions that this robot can do. */
  private async make(): Promise<void> {
    this.made = true;
    const map = this.context.robot ? this.context.fleet.get(this.context.robot).map : null;
    const found: string[] = [];
    for (const text of missions(map?.places.map(({ name }) => name) ?? [])) {
      if (found.length < MOST && (await this.service("check", text)).ok) found.push(text);
    }
    if (!found.length) this.made = false; // the server didn't answer
    const offers = found.map((text) => h("button", { type: "button", class: "starter", dir: "auto", lang: "en", onclick: () => this.take(text) }, h("pre", {}, text)));
    fill(this.element, h("h2", {}, t("write.start")), h("div", { class: "starters" }, ...offers), map && h("div", { class: "place" }, this.map.canvas));
    this.map.redraw();
  }
}

/** Missions that begin with what most robots can do, about places where it knows some. */
function missions(places: string[]): string[] {
  const [one, other = one] = places.filter((name) => !/dock/.test(name));
  return [
    ...(one ? [`go to the ${one}\nsay "Here I am."\n`, `# A round, twice\nrepeat 2 times:\n  go to the ${one}\n  go to the ${other}\n`, `try up to 3 times: go to the ${other}\notherwise say "I can't get there."\n`] : []),
    'say "Hello" and wave\n', "repeat 2 times:\n  wave\n  nod\n", 'move forward 1 m\nsay "Done"\n',
  ];
}
