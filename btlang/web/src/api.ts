// Requests to the server that this page came from, and to no other.
import { said, t } from "./texts";

/** What the server answers to a command. */
export interface Answer {
  ok: boolean;
  text: string;
  code: string;
  data: Record<string, any>;
}

/** Somebody who is logged in. */
export interface Me {
  user: string;
  role: Role;
  /** The port of the process of the emergency stop, 0 for none. */
  stop: number;
  /** The address of the only screen of this server, [] where it has all. */
  screen: string[];
}

export const ROLES = ["viewer", "operator", "editor", "administrator"] as const;
export type Role = (typeof ROLES)[number];

/** Whether somebody has a role, or one that may do more. */
export function may(me: Me, role: Role): boolean {
  return ROLES.indexOf(me.role) >= ROLES.indexOf(role);
}

/** Messages about a text, each with its line. */
function inWords(messages: { message: string; hint: string; line: number }[]): string {
  return messages.map(({ message, hint, line }) => [line && `${t("write.line", { line })}:`, message, hint].filter(Boolean).join(" ")).join("\n");
}

/** A request that failed: the HTTP status (0: nobody answered), what the server says, and all of its answer. */
export class RequestError extends Error {
  constructor(
    readonly status: number,
    text: string,
    readonly data: any = {},
  ) {
    super(inWords(data.data?.messages ?? []) || said(text.replace(/^btc: error BT\d+: /, ""))); // which is for a terminal
  }
}

let csrf = "";

/** The answer to a request, an object. Throws RequestError. */
export async function request(method: string, path: string, body?: unknown, signal?: AbortSignal): Promise<any> {
  const answer = await answered(path, {
    method,
    headers: { "content-type": "application/json", "x-csrf-token": csrf },
    ...(body === undefined ? {} : { body: JSON.stringify(body) }),
    ...(signal ? { signal } : {}),
  });
  return translated(await answer.json().catch(() => ({})));
}

/** An answer with its messages in the language of the page. */
function translated(answer: any): any {
  for (const each of [...(answer.messages ?? []), ...(answer.data?.messages ?? [])]) for (const part of ["message", "hint"]) each[part] &&= said(each[part]);
  return answer;
}

/** A text that isn't JSON. Throws RequestError. */
export async function requestText(path: string): Promise<string> {
  return (await answered(path)).text();
}

async function answered(path: string, options: RequestInit = {}): Promise<Response> {
  const answer = await fetch(path, options).catch((error) => { throw new RequestError(0, String(error)); });
  if (answer.ok) return answer;
  const data = translated(await answer.json().catch(() => ({})));
  throw new RequestError(answer.status, data.text ?? answer.statusText, data);
}

/** Stops a robot through the process that is for nothing else. Throws RequestError. */
export async function stopBeside(me: Me, robot: string): Promise<void> {
  if (!me.stop) throw new RequestError(0, "there is no such process");
  const place = `${location.protocol}//${location.hostname}:${me.stop}/api/stop`;
  // text, so that the browser sends it without asking first
  await answered(place, { method: "POST", credentials: "include", headers: { "content-type": "text/plain" }, body: JSON.stringify({ robot, csrf }) });
}

export const post = (path: string, body: unknown): Promise<any> => request("POST", path, body);

/** Who is logged in, null for nobody. Throws RequestError if the server doesn't answer. */
export async function whoAmI(): Promise<Me | null> {
  try {
    return known(await request("GET", "/api/me"));
  } catch (error) {
    if (error instanceof RequestError && error.status === 401) return null;
    throw error;
  }
}

/** Begins a session. Throws RequestError. */
export async function logIn(name: string, password: string): Promise<Me> {
  return known(await post("/api/login", { name, password }));
}

/** Begins the session of `btc edit` or `btc watch`, whose address has a token that is good once. Throws RequestError. */
export async function enter(token: string): Promise<Me> {
  return known(await post("/api/login", { token }));
}

/** Ends the session. */
export async function logOut(): Promise<void> {
  await post("/api/logout", {});
}

function known(data: any): Me {
  csrf = data.csrf ?? "";
  return { user: data.user, role: data.role, screen: data.screen ?? [], stop: data.stop ?? 0 };
}
