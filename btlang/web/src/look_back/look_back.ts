// What the robots did: the tasks that are over, newest first, the films of those that were recorded, and two side by side.
import { address } from "../address";
import { request } from "../api";
import { fill, h, menuButton, set } from "../dom";
import { downloadItems, pictures, textBlob, type Offer } from "../download";
import { called, command, type Task } from "../tasks/queue";
import { language, moment, said, t, type Key } from "../texts";
import type { Context, View } from "../view";
import { Comparison, titleOf, type Compared } from "./compare";
import { Player } from "./player";
import type { Film } from "./scene";

interface Recording {
  name: string;
  task: number;
  time: number;
}

const OVER = ["completed", "failed", "canceled", "killed", "error", "skipped"];
const BAD = ["failed", "killed", "error"];
const WITH = "with";
const MOST = 12; // steps that are listed

/** See `View`. #/runs lists; #/runs/ROBOT/NAME plays a recording, #/runs/ROBOT/NAME/12.5 from that moment on;
 * #/runs/ROBOT/NAME/with lists those to compare it with, #/runs/ROBOT/NAME/with/OTHER/12.5 compares. */
export function openLookBack(context: Context): View {
  const [robot, name, third, other, moment] = context.path;
  if (!robot || !name) return openList(context, "");
  if (third !== WITH) return openFilm(context, robot, name, Number(third) || 0);
  return other ? openComparison(robot, name, other, moment === undefined ? null : Number(moment) || 0) : openList({ ...context, robot }, name);
}

const query = (robot: string): string => `robot=${encodeURIComponent(robot)}`;
const share = (): HTMLElement => h("button", { type: "button", onclick: () => void navigator.clipboard.writeText(location.href) }, t("runs.share"));

/** A screen of what the server answers, which `make` shows. */
function openAnswer<T>(path: string, make: (answer: T) => { title: HTMLElement; element: HTMLElement; close: () => void }): View {
  const element = h("section", { class: "page film-page" }, h("p", { class: "empty" }, t("film.loading")));
  let close = (): void => undefined;
  let closed = false;
  void request("GET", path).then(
    (answer: T & { ok: boolean; text: string }) => {
      if (closed) return;
      if (!answer.ok) return fill(element, h("p", { class: "problem" }, said(answer.text)));
      const made = make(answer);
      close = made.close;
      fill(element, made.title, made.element);
    },
    (error: Error) => fill(element, h("p", { class: "problem", role: "alert" }, error.message)),
  );
  return { element, close: () => { closed = true; close(); } };
}

function openFilm({ me }: Context, robot: string, name: string, at: number): View {
  return openAnswer(`/api/films/${encodeURIComponent(name)}?${query(robot)}&language=${language()}`, (film: Film) => {
    const player = new Player(film, at, (seconds) => history.replaceState(null, "", address("runs", robot, name, seconds.toFixed(1))));
    const of = `/${encodeURIComponent(name)}?${query(robot)}`;
    const xml = async (): Promise<Blob> => {
      const answer = await request("GET", `/api/trees${of}`);
      if (!answer.ok) throw new Error(answer.text);
      return textBlob(answer.xml);
    };
    const problem = h("p", { class: "problem", role: "alert" });
    const offers = (): Offer[] => [
      { key: "download.mcap", ending: "mcap", content: async () => `/api/recordings${of}` },
      { key: "download.xml", ending: "xml", content: xml },
      ...(film.text ? [{ key: "download.english", ending: "txt", content: async () => textBlob(film.text) } as const] : []),
      ...pictures(player.scene.tree),
    ];
    const began = Number(film.about["wall"]) || 0;
    const download = menuButton(t("download"), () => downloadItems(() => [titleOf(film), began], offers(), (text) => fill(problem, text)));
    const compare = h("a", { class: "button", href: address("runs", robot, name, WITH) }, t("compare.with"));
    const often = h("div", { class: "card summary often", hidden: true, tabindex: 0 });
    const show = async (): Promise<void> => {
      often.hidden = !often.hidden;
      set(heat, { "aria-pressed": String(!often.hidden) });
      if (often.hidden) return player.scene.markFailed([], 0);
      const answer = await request("GET", `/api/failures${of}`).catch((error: Error) => ({ ok: false, text: error.message }));
      if (answer.ok) showFailures(often, film, answer, player);
      else fill(problem, answer.text);
    };
    const heat = h("button", { type: "button", "aria-pressed": "false", onclick: () => void show() }, t("often"));
    player.element.prepend(often);
    const others = me.screen.length ? [] : [heat, compare, share()];
    const title = h("div", { class: "title" }, h("h1", { dir: "auto" }, titleOf(film)), h("div", { class: "controls" }, ...others, download), problem);
    return { title, element: player.element, close: () => player.close() };
  });
}

/** What failed in the latest runs of a mission; see count_failures in btlang/recording/film.py. */
interface Failures {
  runs: number;
  failed: number;
  failures: [node: number, runs: number][];
}

function showFailures(element: HTMLElement, { nodes, root }: Film, { runs, failed, failures }: Failures, { scene }: Player): void {
  const inner = new Set(nodes.map(({ parent }) => parent));
  const steps = failures.filter(([node]) => node >= root && !inner.has(node)).sort(([, one], [, other]) => other - one);
  const buttons = steps.slice(0, MOST).map(([node, count]) => h("button", { type: "button", dir: "auto", onclick: () => scene.select(node) }, `${nodes[node]!.label}: ${count}/${runs}`));
  fill(element, h("p", {}, t("often.sum", { failed, runs })), h("div", { class: "controls" }, ...buttons));
  scene.markFailed(failures, runs);
}

function openComparison(robot: string, name: string, other: string, at: number | null): View {
  return openAnswer(`/api/comparisons/${encodeURIComponent(name)}?${query(robot)}&with=${encodeURIComponent(other)}&language=${language()}`, (compared: Compared) => {
    const moved = (seconds: number): void => history.replaceState(null, "", address("runs", robot, name, WITH, other, seconds.toFixed(1)));
    const comparison = new Comparison(compared, at, moved);
    const another = h("a", { class: "button", href: address("runs", robot, name, WITH) }, t("compare.another"));
    const title = h("div", { class: "title" }, h("h1", {}, t("compare.title")), h("div", { class: "controls" }, another, share()));
    return { title, element: comparison.element, close: () => comparison.close() };
  });
}

/** `chosen` is the recording that is compared with another one, "" for none. */
function openList(context: Context, chosen: string): View {
  const list = h("ol", { class: "tasks" });
  const problem = h("p", { class: "problem", role: "alert" });
  const again = async (task: Task): Promise<void> => {
    fill(problem);
    await command(context, "again", { task: task.id }).catch((error: Error) => fill(problem, error.message));
  };
  const acts = (task: Task, name: string | undefined): (HTMLElement | false)[] => {
    const link = (key: Key, ...path: string[]): HTMLElement => h("a", { class: "button", href: address("runs", context.robot, ...path) }, t(key));
    const [first, second] = [chosen, name ?? ""].sort() as [string, string]; // names begin with the time
    if (chosen) return name === chosen ? [h("span", { class: "pill good" }, t("compare.chosen"))] : [name !== undefined && link("compare.with_this", first, WITH, second)];
    const mayGiveWork = context.me.role !== "viewer";
    return [
      name !== undefined && link("runs.replay", name),
      name !== undefined && link("compare.with", name, WITH),
      mayGiveWork && h("button", { type: "button", onclick: () => void again(task) }, t("runs.again")),
    ];
  };
  const show = async (): Promise<void> => {
    const { recordings } = await request("GET", `/api/recordings?${query(context.robot)}`).catch(() => ({ recordings: [] }));
    const recorded = new Map((recordings as Recording[]).map((each) => [each.task, each.name]));
    const tasks = ((await command(context, "list", { states: OVER }).catch(() => ({}) as Record<string, any>))["tasks"] ?? []) as Task[];
    const shown = tasks.filter((task) => !chosen || recorded.has(task.id));
    fill(
      list,
      ...shown.map((task) =>
        h(
          "li",
          { class: "card" },
          h("span", { class: "number" }, `#${task.id}`),
          h("span", { class: "what", dir: "auto" }, called(task)),
          h("span", { class: `pill ${BAD.includes(task.state) ? "bad" : task.state === "completed" ? "good" : "quiet"}` }, t(`state.${task.state}` as Key)),
          h("span", { class: "why", dir: "auto" }, [task.ended && moment(task.ended), task.person, said(task.reason)].filter(Boolean).join(" · ")),
          h("span", { class: "acts" }, ...acts(task, recorded.get(task.id))),
        ),
      ),
    );
    if (!shown.length) fill(list, h("li", { class: "empty" }, t("runs.none")));
    else if (chosen && shown.length === 1) list.append(h("li", { class: "empty" }, t("compare.none")));
  };
  void show();
  const unwatch = context.fleet.watch((robot, kind, news) => {
    if ((kind === "change" && OVER.includes(news!["state"])) || (kind === "up" && (!context.robot || robot.name === context.robot))) void show();
  });
  const choosing = chosen && h("p", { class: "choosing" }, h("span", {}, t("compare.choose")), h("a", { href: address("runs", context.robot, chosen) }, t("cancel")));
  return { element: h("section", { class: "page" }, h("h1", {}, t("tab.runs")), choosing || null, problem, list), close: unwatch };
}
