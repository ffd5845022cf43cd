// The emergency stop, on every screen: one touch or one key, over three ways at once. What it shows comes from the server.
import { may, request, stopBeside, type Me } from "./api";
import { fill, h } from "./dom";
import type { Fleet, Robot } from "./fleet";
import type { Link } from "./socket";
import { said, t } from "./texts";

const CONFIRMED = 900; // milliseconds in which a stop has to be confirmed; people are warned within a second

const MISSED = 20_000; // milliseconds for which it is said that a stop didn't reach a robot

/** Of one robot since the button was pressed; "missed" where it was lost, and the robot says by now that it isn't stopped. */
type Pressed = "sent" | "confirmed" | "lost" | "missed";

/** `robots` are those that a press stops, [""] where the server has to know which. */
export class EmergencyStop {
  readonly button = h("button", { class: "stop", type: "button", title: t("stop.title"), "aria-keyshortcuts": "Pause Control+Shift+Period", onclick: () => this.press() }, t("stop"));
  readonly banner = h("div", { class: "stops" });
  private said = h("p", { class: "alarm", role: "alert" });
  private latched = h("div", { class: "latches", role: "status" });
  private pressed = new Map<string, Pressed>();
  private shown = "";
  private onKey = (event: KeyboardEvent) => {
    if (event.key !== "Pause" && !(event.ctrlKey && event.shiftKey && event.code === "Period")) return;
    event.preventDefault();
    if (!event.repeat) this.press();
  };
  private unwatch: () => void;

  constructor(
    private fleet: Fleet,
    private link: Link,
    private me: Me,
    private robots: () => string[],
  ) {
    this.banner.append(this.said, this.latched);
    addEventListener("keydown", this.onKey, { capture: true });
    this.unwatch = fleet.watch((robot, kind) => {
      if (kind === "robot" && robot.state?.stopped && this.pressed.has(robot.name)) this.pressed.delete(robot.name);
      if ((kind === "ages" || kind === "old") && this.pressed.get(robot.name) === "lost" && robot.isHeard && robot.state) this.settle(robot);
      if (["robot", "up", "away", "offline", "old"].includes(kind)) this.show();
    });
    this.show();
  }

  /** Stops the robots. */
  press(): void {
    for (const robot of this.robots()) void this.stop(robot);
  }

  close(): void {
    removeEventListener("keydown", this.onKey, { capture: true });
    this.unwatch();
  }

  private async stop(robot: string): Promise<void> {
    this.note(robot, "sent");
    const timer = setTimeout(() => this.pressed.get(robot) === "sent" && this.note(robot, "lost"), CONFIRMED);
    const bySocket = this.link.send(robot, "emergency_stop").then((answer) => answer.ok || Promise.reject(new Error(answer.text)));
    try {
      await Promise.any([request("POST", "/api/stop", { robot }), bySocket, stopBeside(this.me, robot)]);
      if (this.pressed.has(robot)) this.note(robot, "confirmed");
    } catch {
      if (this.pressed.has(robot)) this.note(robot, "lost");
    } finally {
      clearTimeout(timer);
    }
  }

  /** Says what became of a stop that nobody had confirmed, once the robot is heard again. */
  private settle(robot: Robot): void {
    if (robot.state?.stopped) this.pressed.delete(robot.name);
    else {
      this.note(robot.name, "missed");
      setTimeout(() => this.pressed.get(robot.name) === "missed" && this.pressed.delete(robot.name) && this.show(), MISSED);
    }
    this.show();
  }

  private async release(robot: Robot): Promise<void> {
    try {
      await request("POST", "/api/commands", { command: "release", robot: robot.name });
      this.pressed.delete(robot.name);
      this.show();
    } catch (error) {
      fill(this.said, (error as Error).message || t("offline"));
    }
  }

  private note(robot: string, pressed: Pressed): void {
    this.pressed.set(robot, pressed);
    this.show();
  }

  /** Draws what is known now. */
  show(): void {
    fill(this.button, this.robots().length > 1 ? t("stop.all") : t("stop"));
    const by = (wanted: Pressed) => [...this.pressed].filter(([, each]) => each === wanted).map(([name]) => name || t("robot.the"));
    const text = [
      ...by("lost").map((robot) => t("stop.lost", { robot })),
      ...by("missed").map((robot) => t("stop.missed", { robot })),
      ...by("sent").map((robot) => t("stop.sent", { robot })),
      ...by("confirmed").map((robot) => t("stop.confirmed", { robot })),
    ].join(" ");
    if (text !== this.said.textContent) fill(this.said, text);
    this.said.classList.toggle("lost", by("lost").length + by("missed").length > 0);
    const latched = [...this.fleet.robots.values()].filter((robot) => robot.state?.stopped);
    const shown = JSON.stringify(latched.map((robot) => [robot.name, robot.state!.stopped, robot.isHeard]));
    if (shown === this.shown) return; // else a button would vanish under a finger
    this.shown = shown;
    fill(this.latched, ...latched.map((robot) => this.latch(robot)));
  }

  private latch(robot: Robot): HTMLElement {
    return h(
      "div",
      { class: "latch" },
      h("p", {}, h("strong", { dir: "auto" }, t("stop.latched", { robot: robot.name })), " ", h("span", { dir: "auto" }, said(robot.state!.stopped)), !robot.isHeard && ` (${t("robot.unheard")})`),
      may(this.me, "operator") && h("button", { type: "button", class: "release", onclick: () => void this.release(robot) }, t("stop.release")),
    );
  }
}
