// What the shell gives to the screens, and they to it.
import type { Me } from "./api";
import type { Fleet } from "./fleet";
import type { Presence } from "./presence";
import type { Link } from "./socket";

/** `robot` is the name of the robot that is shown, `path` what follows it in the address. */
export interface Context {
  me: Me;
  fleet: Fleet;
  link: Link;
  presence: Presence;
  robot: string;
  path: string[];
}

/** A screen. `close` ends what it has begun. */
export interface View {
  element: HTMLElement;
  close(): void;
}

export type Open = (context: Context) => View;
