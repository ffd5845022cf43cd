// The tasks of a robot that aren't over, as it lists them; asked for again whenever one changes.
import { request } from "../api";
import type { Context } from "../view";

export interface Task {
  id: number;
  mission: string;
  state: string;
  priority: number;
  person: string;
  waits: string;
  reason: string;
  created: number;
  ended: number | null;
}

/** What a task is called: the beginning of its mission, or of the comment before it. */
export const called = (task: { mission: string }): string => task.mission.replace(/^#+\s*/, "");

/** A command to the robot of a screen; its data. Throws RequestError with what the robot says. */
export async function command(context: Context, name: string, fields: Record<string, unknown> = {}): Promise<Record<string, any>> {
  return (await request("POST", "/api/commands", { command: name, robot: context.robot, ...fields })).data;
}

export class Queue {
  tasks: Task[] = [];
  private hindrance = "";
  private asking = false;
  private again = false;
  private unwatch: () => void;

  /** `changed` is called whenever there is something new. */
  constructor(
    private context: Context,
    private changed: () => void,
  ) {
    this.unwatch = context.fleet.watch((robot, kind) => {
      if (robot.name !== context.robot) return;
      const hindrance = robot.state?.hindrance ?? "";
      if (kind === "change" || kind === "up" || (kind === "robot" && hindrance !== this.hindrance)) void this.ask();
      if (kind === "robot") this.hindrance = hindrance;
    });
    void this.ask();
  }

  /** The task that the robot does now. */
  get underway(): Task | null {
    return this.tasks.find((task) => task.state === "underway" || task.state === "standby") ?? null;
  }

  close(): void {
    this.unwatch();
  }

  /** Asks the robot now. */
  async ask(): Promise<void> {
    if (this.asking) {
      this.again = true;
      return;
    }
    this.asking = true;
    try {
      this.tasks = (await command(this.context, "list"))["tasks"] as Task[];
      this.changed();
    } catch {
      // It's asked again when the robot is back.
    } finally {
      this.asking = false;
      if (this.again) {
        this.again = false;
        void this.ask();
      }
    }
  }
}
