// The WebSocket of the server: comes back by itself, and after a cut asks for the changes of tasks that it missed.
import type { Answer } from "./api";

/** A message about a robot, as docs/server.md describes them. */
export interface News {
  type: string;
  robot: string;
  [field: string]: any;
}

interface Subscription {
  robots?: string[];
  topics: string[];
  rate: number;
  language?: string;
}

/** What a page shows. `mission` is the name of the one that is open, `changing` that it isn't saved. */
export interface Place {
  robot: string;
  screen: string;
  mission: string;
  changing: boolean;
}

/** A page that is open somewhere, and what it shows. */
export interface OpenPage extends Place {
  page: number;
  user: string;
}

const REVOKED = 4001;
const AGAIN = 1000; // milliseconds until it tries again
const SILENCE = 4000; // milliseconds without a word after which it asks whether anybody is there
const PATIENCE = 35_000; // milliseconds for an answer, as the server has for a robot

/** `take` gets all news, `changed` whether there is a connection now, `left` that the session has ended, `met` the other
 *  pages that are open now.
 */
export class Link {
  online = false;
  private socket: WebSocket | null = null;
  private number = 0;
  private waiting = new Map<number, (answer: Answer) => void>();
  private subscription: Subscription | null = null;
  private place: Place | null = null;
  private page = 0;
  private after: Record<string, number> = {};
  private heard = 0;
  private asked = false;
  private closed = false;

  constructor(
    private take: (news: News) => void,
    private changed: (online: boolean) => void,
    private left: () => void,
    private met: (others: OpenPage[]) => void,
  ) {
    this.connect();
    setInterval(() => this.look(), SILENCE / 2);
    addEventListener("online", () => this.socket ?? this.connect());
  }

  /** What is heard from now on; it's asked for again after each cut. */
  subscribe(subscription: Subscription): void {
    this.subscription = subscription;
    this.ask();
  }

  /** Says what this page shows from now on, also after each cut. */
  show(place: Place): void {
    if (JSON.stringify(place) === JSON.stringify(this.place)) return;
    this.place = place;
    this.introduce();
  }

  /** The answer of a robot to a command. Rejected if there is no connection, or it's cut before the answer. */
  send(robot: string, command: string, fields: Record<string, unknown> = {}): Promise<Answer> {
    return new Promise((resolve, reject) => {
      if (!this.online) return reject(new Error("offline"));
      const id = this.say({ command, robot, ...fields });
      const timer = setTimeout(() => this.waiting.delete(id) && reject(new Error("silent")), PATIENCE);
      this.waiting.set(id, (answer) => {
        clearTimeout(timer);
        if (answer) resolve(answer);
        else reject(new Error("cut"));
      });
    });
  }

  /** Ends it for good. */
  close(): void {
    this.closed = true;
    this.socket?.close();
  }

  private connect(): void {
    if (this.closed) return;
    const socket = new WebSocket(`${location.origin.replace("http", "ws")}/api/ws`);
    this.socket = socket;
    this.heard = performance.now();
    socket.onmessage = (event) => socket === this.socket && this.read(event.data);
    socket.onclose = (event) => socket === this.socket && this.gone(event.code);
  }

  private gone(code: number): void {
    this.socket = null;
    this.online = this.asked = false;
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const each of waiting) each(null as unknown as Answer);
    this.met([]);
    this.changed(false);
    if (code === REVOKED || code === 4003) this.left();
    else setTimeout(() => this.socket ?? this.connect(), AGAIN);
  }

  private look(): void {
    const silent = performance.now() - this.heard;
    if (!this.socket || silent < SILENCE) return;
    if (silent > 2 * SILENCE) {
      const socket = this.socket;
      this.gone(0);
      socket.close();
    } else if (this.online && !this.asked) {
      this.asked = true;
      this.say({ type: "ping" });
    }
  }

  private read(text: string): void {
    const message = JSON.parse(text);
    this.heard = performance.now();
    this.asked = false;
    if (message.type === "auth_ok") {
      this.online = true;
      this.changed(true);
      this.ask();
      this.introduce();
    } else if (message.type === "auth_required") {
      this.left();
    } else if (message.type === "lost") {
      this.ask();
    } else if (message.type === "result") {
      this.waiting.get(message.id)?.(message);
      this.waiting.delete(message.id);
    } else if (message.type === "people") {
      this.met((message.people as OpenPage[]).filter(({ page }) => page !== this.page));
    } else if (message.robot !== undefined) {
      if (message.type === "change") this.after[message.robot] = message.number;
      if (message.type === "up") this.begin(message as News);
      this.take(message);
    }
  }

  private begin(news: News): void {
    const known = this.after[news.robot];
    if (known === undefined || news["change"] < known) this.after[news.robot] = news["change"]; // smaller: another store
  }

  private ask(): void {
    if (this.online && this.subscription) this.say({ type: "subscribe", ...this.subscription, after: this.after });
  }

  private introduce(): void {
    if (!this.online || !this.place) return;
    const id = this.say({ type: "presence", ...this.place });
    this.waiting.set(id, (answer: any) => (this.page = answer?.page ?? 0));
  }

  private say(message: object): number {
    this.number += 1;
    this.socket?.send(JSON.stringify({ id: this.number, ...message }));
    return this.number;
  }
}
