// The components and devices of a robot, with their states, and what its cameras see.
import { may } from "../api";
import { fill, h } from "../dom";
import type { Component, Device, Robot } from "../fleet";
import { command } from "../tasks/queue";
import { said, t } from "../texts";
import type { Context } from "../view";

const PERIOD = 700; // milliseconds between two pictures of a camera

export class Parts {
  readonly element = h("details", { class: "card parts", hidden: true }, h("summary", {}, t("parts.title")));
  private list = h("ul", {});
  private problem = h("p", { class: "problem", role: "alert" });
  private cameras = new Map<string, Camera>();
  private shown = "";

  constructor(private context: Context) {
    this.element.append(this.problem, this.list);
  }

  close(): void {
    for (const camera of this.cameras.values()) camera.close();
  }

  /** What is known of the robot by now. */
  show(robot: Robot): void {
    const { components, devices } = robot.parts;
    const shown = JSON.stringify([components, devices, robot.up]);
    if (shown === this.shown) return;
    this.shown = shown;
    this.element.hidden = !(components.length || devices.length);
    fill(this.list, ...components.map((each) => this.component(each, robot.up)), ...devices.map((each) => this.device(each)));
  }

  private component(each: Component, up: boolean): HTMLElement {
    const wrong = each.state !== "active";
    const restart = h("button", { type: "button", disabled: !up, onclick: () => void this.restart(each.name) }, t("parts.restart"));
    const about = [each.place, each.version, each.starts > 1 && t("parts.starts", { count: String(each.starts) })].filter(Boolean).join(" · ");
    return this.line(each.name, said(each.state), wrong, about, said(each.why), may(this.context.me, "administrator") && restart);
  }

  private device(each: Device): HTMLElement {
    const state = each.silent ? t("parts.silent") : t("parts.works");
    const line = this.line(each.name, state, each.silent !== "", [each.kind, each.driver, each.port].filter(Boolean).join(" · "), said(each.silent), false);
    if (each.kind === "camera") {
      let camera = this.cameras.get(each.name);
      if (!camera) this.cameras.set(each.name, (camera = new Camera(this.context, each.name)));
      line.append(camera.element);
    }
    return line;
  }

  private line(name: string, state: string, wrong: boolean, about: string, why: string, button: HTMLElement | false): HTMLElement {
    const pill = h("span", { class: wrong ? "pill bad" : "pill good" }, state);
    return h("li", {}, h("strong", { dir: "auto" }, name), pill, h("small", { dir: "auto" }, about), why && h("p", { class: "why", dir: "auto" }, why), button);
  }

  private async restart(name: string): Promise<void> {
    fill(this.problem);
    try {
      await command(this.context, "change_component", { name, act: "restart" });
    } catch (error) {
      fill(this.problem, (error as Error).message);
    }
  }
}

/** What a camera sees, asked for as long as somebody looks. */
class Camera {
  private picture = h("img", { alt: "", hidden: true });
  private said = h("p", { class: "why", role: "status" });
  readonly element = h("details", { class: "camera", ontoggle: () => void this.look() }, h("summary", {}, t("parts.look")), this.picture, this.said);
  private timer = 0;

  constructor(
    private context: Context,
    private name: string,
  ) {
    this.picture.alt = t("parts.sees", { name });
  }

  close(): void {
    clearTimeout(this.timer);
    this.element.removeAttribute("open");
  }

  private async look(): Promise<void> {
    clearTimeout(this.timer);
    if (!this.element.hasAttribute("open") || !this.element.isConnected) return;
    try {
      const { png } = await command(this.context, "picture", { device: this.name });
      this.picture.src = `data:image/png;base64,${png}`;
      this.picture.hidden = false;
      fill(this.said);
    } catch (error) {
      this.picture.hidden = true; // an old picture would look like a new one
      fill(this.said, (error as Error).message);
    }
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.look(), PERIOD);
  }
}
