// What is known of the robots, from the messages of the server alone.
import { whole, type RunEvent } from "./events";
import type { News } from "./socket";
import type { Place } from "./watch/words";

export const STATUSES = ["IDLE", "RUNNING", "SUCCESS", "FAILURE", "SKIPPED"] as const;
export type Status = (typeof STATUSES)[number];

/** What the statuses of a node that only asks mean. */
export const ANSWERS: Partial<Record<Status, "TRUE" | "FALSE">> = { SUCCESS: "TRUE", FAILURE: "FALSE" };

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
  lanes?: Lane[];
  dock: { x: number; y: number } | null;
}

/** `kind` is "keep out", "slow", or "open" for one that is closed otherwise. */
export interface Zone {
  name: string;
  kind: string;
  points: Point[];
}

/** A straight piece of the ways that the robot keeps to. */
export interface Lane {
  start: Point;
  end: Point;
  one_way: boolean;
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
  /** Those that only ask: a failure of theirs is the answer "no". */
  asks: Set<number>;
  /** The house rules round it, and the first node of the mission itself. */
  rules: Rule[];
  root: number;
  /** What the mission was read from, "" for nothing, and where it says each node. */
  text: string;
  places: Place[];
}

/** A house rule: its node, what it does, and its words. */
export type Rule = [node: number, does: number, words: string];

/** A line of the log: an event, or a command or condition with a new status. */
export interface Entry {
  task: number;
  wall: number;
  event: RunEvent | { event: Status | "TRUE" | "FALSE"; name: string; node?: number };
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

/** The seconds after which a reading is shown as old. */
const OLD = 2;
const MINUTE = 60;
const LOOK = 250; // milliseconds between two looks at the ages

const MOST_ENTRIES = 500;
const MOST_STEPS = 2000;

/** What is known of a robot that hasn't said anything yet. */
const unknown = () => ({
  state: null as { stopped: string; paused: boolean; hindrance: string; acting?: boolean; pose: [number, number, number] | null; battery: number | null; left: string | null; right: string | null; visitors?: boolean; talks?: boolean } | null,
  map: null as WorldMap | null,
  /** Those that may be elsewhere than the map has them. */
  things: [] as Thing[],
  /** What it asks, "" for nothing. */
  asking: "",
  parts: { components: [] as Component[], devices: [] as Device[] },
  /** What its scanner saw, counter-clockwise from straight ahead, and where it was then. */
  scan: null as { ranges: (number | null)[]; pose: [number, number, number] } | null,
  /** The positions of its joints in radians and metres, in the order of its URDF; [] if its body has no links. */
  joints: [] as (number | null)[],
  /** What it speaks now, "" for nothing, and the characters of the word of now. */
  speech: { text: "", start: 0, end: 0 },
  /** What its mission counts or measures now, by name. */
  values: {} as Record<string, number>,
  /** Where it is going, as far as its navigation tells. */
  way: [] as Point[],
  /** Its task, 0 for none, its goal, and what it said and heard last, "" for nothing. */
  doing: { task: 0, goal: "", says: "", heard: "" },
});

export interface Robot extends ReturnType<typeof unknown> {}

/** One robot, as its messages have it: the same as `RobotView` in btlang/server/live/robot_view.py, with a log and a path. */
export class Robot {
  up = false;
  /** The server says that it can't reach it. */
  away = false;
  /** The latest mission. */
  run: Run | null = null;
  /** What it does between missions. */
  rules: Run | null = null;
  entries: Entry[] = [];
  /** Where it has been. */
  path: Point[] = [];
  /** When its state and its scan were read, and when it was heard, in seconds on the clock of this page; null for never. */
  private read = { state: null as number | null, scan: null as number | null, heard: null as number | null };
  private delay = new Delay();
  private fresh = false; // its next statuses are those that it had when the page came, not changes

  constructor(readonly name: string) {
    Object.assign(this, unknown());
  }

  /** Takes in a message; null is the loss of the connection. */
  take(news: News | null): void {
    if (news?.type === "up") {
      Object.assign(this, unknown(), { up: true, away: false, fresh: true });
      this.read = { state: null, scan: null, heard: null };
      this.delay = new Delay();
    } else if (news?.type === "ages") this.note(news);
    else if (!news || news.type === "away") Object.assign(this, { up: false, away: news !== null, state: null });
    else if (news.type === "run") this.begin(news);
    else if (news.type === "statuses") this.change(news);
    else {
      this.fresh = false;
      if (news.type === "event" && (news["task"] || news["event"].event !== "end")) this.log(entryOf(news)); // rules alone end with each task
      else if (news.type === "robot") this.move(news);
      else if (news.type === "map") this.map = news as unknown as WorldMap;
      else if (news.type === "things") this.things = news["things"];
      else if (news.type === "asking") this.asking = news["text"];
      else if (news.type === "scan") this.scan = news["pose"] ? { ranges: news["ranges"], pose: news["pose"] } : null;
      else if (news.type === "way") this.way = news["points"];
      else if (news.type === "joints") this.joints = news["positions"];
      else if (news.type === "speech") this.speech = { text: news["text"], start: news["start"], end: news["end"] };
      else if (news.type === "values") this.values = news["values"];
      else if (news.type === "components") this.parts = { components: news["components"], devices: news["devices"] };
      else if (news.type === "doing") this.doing = { task: news["task"], goal: news["goal"], says: news["says"], heard: news["heard"] };
    }
  }

  /** How many seconds ago what is shown of it was read, rounded down; 0 for what is true now, null where nobody knows. */
  get age(): number | null {
    return this.since(this.read.state);
  }

  /** The same of what its scanner saw. */
  get scanAge(): number | null {
    return this.since(this.read.scan);
  }

  /** Whether what was said of it lately, such as that it is stopped, is true now. */
  get isHeard(): boolean {
    return this.since(this.read.heard) === 0;
  }

  private since(read: number | null): number | null {
    if (read === null || this.read.heard === null) return null;
    const age = now() - Math.min(read, this.read.heard);
    return age > OLD ? Math.floor(age) : 0;
  }

  private note(news: News): void {
    const late = this.delay.of(now() - news["t"]);
    const at = (age: number | null): number | null => (age === null ? null : now() - late - age);
    this.read = { state: at(news["state"]), scan: at(news["scan"]), heard: now() - late };
  }

  private begin(news: News): void {
    const nodes: Run["nodes"] = news["nodes"];
    const prepared = new Set<number>(news["prepared"]);
    const run: Run = { id: news["run"], task: news["task"], nodes, statuses: nodes.map(() => "IDLE"), leaves: leavesOf(nodes, prepared), prepared, asks: new Set(news["asks"]), rules: news["rules"] ?? [], root: news["root"] ?? 0, text: news["text"] ?? "", places: news["spans"] ?? [] };
    if (run.task && run.id !== this.run?.id) this.path = this.path.slice(-1);
    this[run.task ? "run" : "rules"] = run;
  }

  private change(news: News): void {
    const run = [this.run, this.rules].find((each) => each?.id === news["run"]);
    if (!run) return;
    for (const [index, words] of (news["words"] ?? []) as [number, string][]) {
      const node = run.nodes[index];
      if (node) node[2] = words;
    }
    for (const [index, status] of news["changes"] as [number, Status][]) {
      const wasRunning = run.statuses[index] === "RUNNING";
      run.statuses[index] = status;
      const asks = run.asks.has(index);
      const isNews = !this.fresh && run.task && run.leaves[index] && !(asks && index < run.root); // rules ask all the time
      const event = asks ? ANSWERS[status] : status;
      if (isNews && event && (event !== "IDLE" || wasRunning)) this.log({ task: run.task, wall: news["t"], event: { event, name: run.nodes[index]![2], node: index } });
    }
  }

  private move(news: News): void {
    this.state = news as unknown as Robot["state"];
    const pose = this.state?.pose;
    if (!pose) return;
    const last = this.path.at(-1);
    if (last && Math.hypot(last[0] - pose[0], last[1] - pose[1]) < 0.02) return;
    this.path.push([pose[0], pose[1]]);
    if (this.path.length > MOST_STEPS) this.path = this.path.filter((_, step) => step % 2 === 0);
  }

  private log(entry: Entry): void {
    this.entries.push(entry);
    if (this.entries.length > MOST_ENTRIES) this.entries.splice(0, MOST_ENTRIES / 10);
  }
}

const now = (): number => performance.now() / 1000;

/** How late messages are, from the differences of two clocks: the least one of the last minutes is on time. */
class Delay {
  private least = Infinity;
  private before = Infinity;
  private until = now() + MINUTE;

  of(difference: number): number {
    if (now() > this.until) [this.before, this.least, this.until] = [this.least, Infinity, now() + MINUTE];
    this.least = Math.min(this.least, difference);
    return difference - Math.min(this.least, this.before);
  }
}

/** The line of the log for a message about an event. */
export function entryOf(news: News): Entry {
  return { task: news["task"], wall: news["event"].wall, event: whole(news["event"]) };
}

export type Kind = "up" | "away" | "run" | "statuses" | "robot" | "map" | "things" | "asking" | "scan" | "way" | "doing" | "joints" | "speech" | "values" | "components" | "event" | "change" | "ages" | "old" | "offline";
export type Watcher = (robot: Robot, kind: Kind, news: News | null) => void;

/** All robots by their names. Watchers are called after each message has been taken in. */
export class Fleet {
  readonly robots = new Map<string, Robot>();
  private watchers = new Set<Watcher>();
  private shown = new Map<string, string>();

  constructor() {
    setInterval(() => this.look(), LOOK);
  }

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
  disconnect(): void {
    for (const robot of this.robots.values()) this.tell(robot, "offline", null);
  }

  take(news: News): void {
    this.tell(this.get(news.robot), news.type as Kind, news);
  }

  /** Tells watchers of readings that have become older, as "old". */
  private look(): void {
    for (const robot of this.robots.values()) {
      const ages = JSON.stringify([robot.age, robot.scanAge, robot.isHeard]);
      if (ages === this.shown.get(robot.name)) continue;
      this.shown.set(robot.name, ages);
      for (const watcher of [...this.watchers]) watcher(robot, "old", null);
    }
  }

  private tell(robot: Robot, kind: Kind, news: News | null): void {
    robot.take(news);
    for (const watcher of [...this.watchers]) watcher(robot, kind, news);
  }
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
