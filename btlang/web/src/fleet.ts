// What is known of the robots, from the messages of the server alone.
import type { News } from "./socket";

export const STATUSES = ["IDLE", "RUNNING", "SUCCESS", "FAILURE", "SKIPPED"] as const;
export type Status = (typeof STATUSES)[number];

/** A point of the world, in metres. */
export type Point = [number, number];

export interface WorldMap {
  walls: Point[][];
  boxes: { x: number; y: number; width: number; height: number }[];
  places: { name: string; x: number; y: number; facing: number | null }[];
  objects: { name: string; x: number; y: number; radius: number }[];
  people: { name: string; x: number; y: number; radius: number; walks?: Point[] }[];
  zones?: Zone[];
  doors?: Door[];
  dock: { x: number; y: number } | null;
}

/** `kind` is "keep out", "slow", or "open" for one that is closed otherwise. */
export interface Zone {
  name: string;
  kind: string;
  points: Point[];
}

export interface Door {
  name: string;
  start: Point;
  end: Point;
  open: boolean;
}

/** Where somebody or something is (metres, null where it isn't there), and whether the robot sees it. */
export type Thing = [name: string, x: number | null, y: number | null, seen: boolean];

/** A mission under way, or the latest one. `task` is 0 for the house rules between tasks. */
export interface Run {
  id: string;
  task: number;
  nodes: [path: string, id: string, label: string, ports?: Record<string, string>][];
  statuses: Status[];
  /** Which nodes are actions and conditions, without what only prepares one of them. */
  leaves: boolean[];
  /** Those whose children but the last only compute values for that one. */
  prepared: Set<number>;
}

export interface Entry {
  task: number;
  wall: number;
  event: Record<string, any>;
}

export interface Component {
  name: string;
  place: string;
  version: string;
  state: string;
  why: string;
  starts: number;
}

/** `silent` is why it tells nothing, "" where it works. */
export interface Device {
  name: string;
  kind: string;
  driver: string;
  port: string;
  silent: string;
}

const MOST_ENTRIES = 500;
const MOST_STEPS = 2000;

/** One robot. `state` is null until it says something, and again when the connection or the robot is gone. */
export class Robot {
  up = false;
  /** The server says that it can't reach it. */
  away = false;
  state: { stopped: string; paused: boolean; hindrance: string; pose: [number, number, number] | null; battery: number | null; left: string | null; right: string | null; visitors?: boolean; talks?: boolean } | null = null;
  map: WorldMap | null = null;
  /** Those that may be elsewhere than the map has them. */
  things: Thing[] = [];
  /** What it asks, "" for nothing. */
  asking = "";
  parts: { components: Component[]; devices: Device[] } = { components: [], devices: [] };
  /** What its scanner saw, counter-clockwise from straight ahead, and where it was then. */
  scan: { ranges: (number | null)[]; pose: [number, number, number] } | null = null;
  /** The latest mission. */
  run: Run | null = null;
  /** What it does between missions. */
  rules: Run | null = null;
  entries: Entry[] = [];
  /** The positions of its joints in radians and metres, in the order of its URDF; [] if its body has no links. */
  joints: (number | null)[] = [];
  /** What it speaks now, "" for nothing, and the characters of the word of now. */
  speech = { text: "", start: 0, end: 0 };
  /** What it heard last. */
  heard = "";
  /** Where it has been. */
  path: Point[] = [];
  /** Where it is going, as far as its navigation tells. */
  way: Point[] = [];
  goal = "";
  says = "";
  /** The task under way, 0 for none. */
  task = 0;
  /** Its next statuses are those that it had when the page came, not changes. */
  fresh = false;

  constructor(readonly name: string) {}
}

export type Kind = "up" | "away" | "run" | "statuses" | "robot" | "map" | "things" | "asking" | "scan" | "way" | "joints" | "speech" | "components" | "event" | "change" | "offline";
export type Watcher = (robot: Robot, kind: Kind, news: News | null) => void;

/** All robots by their names. Watchers are called after each message has been taken in. */
export class Fleet {
  readonly robots = new Map<string, Robot>();
  private watchers = new Set<Watcher>();

  /** Until the function that it returns is called. */
  watch(watcher: Watcher): () => void {
    this.watchers.add(watcher);
    return () => this.watchers.delete(watcher);
  }

  get(name: string): Robot {
    let robot = this.robots.get(name);
    if (!robot) this.robots.set(name, (robot = new Robot(name)));
    return robot;
  }

  /** There is no connection: what was known may no longer be true. */
  lose(): void {
    for (const robot of this.robots.values()) {
      robot.up = robot.away = false;
      robot.state = null;
      this.tell(robot, "offline", null);
    }
  }

  take(news: News): void {
    const robot = this.get(news.robot);
    if (news.type === "up") {
      [robot.up, robot.fresh, robot.away] = [true, true, false];
      [robot.things, robot.asking, robot.joints, robot.heard] = [[], "", [], ""];
      robot.speech = { text: "", start: 0, end: 0 };
    } else if (news.type === "away") {
      [robot.up, robot.away] = [false, true];
      robot.state = null;
    } else if (news.type === "robot") this.state(robot, news);
    else if (news.type === "map") robot.map = news as unknown as WorldMap;
    else if (news.type === "things") robot.things = news["things"];
    else if (news.type === "asking") robot.asking = news["text"];
    else if (news.type === "scan") robot.scan = news["pose"] ? { ranges: news["ranges"], pose: news["pose"] } : null;
    else if (news.type === "way") robot.way = news["points"];
    else if (news.type === "joints") robot.joints = news["positions"];
    else if (news.type === "speech") robot.speech = { text: news["text"], start: news["start"], end: news["end"] };
    else if (news.type === "components") robot.parts = { components: news["components"], devices: news["devices"] };
    else if (news.type === "change") {
      if (news["state"] === "underway") robot.task = news["task"];
      else if (robot.task === news["task"]) robot.task = 0;
    } else if (news.type === "run") begin(robot, news);
    else if (news.type === "statuses") {
      const run = [robot.run, robot.rules].find((each) => each?.id === news["run"]);
      if (!run) return;
      for (const [index, words] of (news["words"] ?? []) as [number, string][]) {
        const node = run.nodes[index];
        if (node) node[2] = words;
      }
      for (const [index, status] of news["changes"] as [number, Status][]) {
        run.statuses[index] = status;
        if (!robot.fresh && run.task && run.leaves[index]) log(robot, { task: run.task, wall: news["t"], event: { event: status, name: run.nodes[index]![2] } });
      }
      robot.fresh = false;
    } else if (news.type === "event") note(robot, news);
    this.tell(robot, news.type as Kind, news);
  }

  private state(robot: Robot, news: News): void {
    robot.state = news as unknown as Robot["state"];
    const pose = robot.state?.pose;
    if (!pose) return;
    const last = robot.path.at(-1);
    if (last && Math.hypot(last[0] - pose[0], last[1] - pose[1]) < 0.02) return;
    robot.path.push([pose[0], pose[1]]);
    if (robot.path.length > MOST_STEPS) robot.path.splice(0, MOST_STEPS / 2);
  }

  private tell(robot: Robot, kind: Kind, news: News | null): void {
    for (const watcher of [...this.watchers]) watcher(robot, kind, news);
  }
}

function begin(robot: Robot, news: News): void {
  const again = robot.run?.id === news["run"];
  const nodes: Run["nodes"] = news["nodes"];
  const prepared = new Set<number>(news["prepared"]);
  const run: Run = { id: news["run"], task: news["task"], nodes, statuses: nodes.map(() => "IDLE"), leaves: leavesOf(nodes, prepared), prepared };
  robot[run.task ? "run" : "rules"] = run;
  robot.task = run.task;
  if (again || !run.task) return;
  robot.path = robot.path.slice(-1);
  robot.goal = robot.says = robot.heard = "";
}

function note(robot: Robot, news: News): void {
  const event = news["event"];
  if (event.event === "navigate") robot.goal = event.name;
  if (["arrive", "stop", "end"].includes(event.event)) [robot.goal, robot.way] = ["", []];
  if (event.event === "say") robot.says = event.text;
  if (event.event === "hear") robot.heard = event.text;
  log(robot, { task: news["task"], wall: event.wall, event });
}

function leavesOf(nodes: Run["nodes"], prepared: Set<number>): boolean[] {
  const paths = new Set(nodes.map(([path]) => path));
  const above = new Set([...prepared].map((index) => nodes[index]?.[0].replace(/^\/$/, "")));
  return nodes.map(([path], index) => {
    const [parent, position] = [path.slice(0, path.lastIndexOf("/")), Number(path.slice(path.lastIndexOf("/") + 1))];
    const prepares = path !== "/" && above.has(parent) && paths.has(`${parent}/${position + 1}`);
    return !prepares && !nodes[index + 1]?.[0].startsWith(path.replace(/\/?$/, "/"));
  });
}

/** The numbers of the actions and conditions that run. */
export function running(run: Run): number[] {
  return run.statuses.flatMap((status, index) => (status === "RUNNING" && run.leaves[index] ? [index] : []));
}

function log(robot: Robot, entry: Entry): void {
  robot.entries.push(entry);
  if (robot.entries.length > MOST_ENTRIES) robot.entries.splice(0, MOST_ENTRIES / 10);
}
