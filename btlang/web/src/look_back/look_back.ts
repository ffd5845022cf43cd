// What the robots did: the tasks that are over, newest first, and the films of those that were recorded.
import { request } from "../api";
import { fill, h } from "../dom";
import { called, command, type Task } from "../tasks/queue";
import { moment, t, type Key } from "../texts";
import { address, type Context, type View } from "../view";
import { Player, type Film } from "./player";

interface Recording {
  name: string;
  task: number;
  time: number;
}

const OVER = ["completed", "failed", "canceled", "killed", "error", "skipped"];
const BAD = ["failed", "killed", "error"];

/** See `View`. #/runs lists, #/runs/ROBOT/NAME plays a recording, #/runs/ROBOT/NAME/12.5 from that moment on. */
export function openLookBack(context: Context): View {
  const [robot, name, moment] = context.path;
  return robot && name ? openFilm(robot, name, Number(moment) || 0) : openList(context);
}

function openFilm(robot: string, name: string, at: number): View {
  const element = h("section", { class: "page film-page" }, h("p", { class: "empty" }, t("film.loading")));
  const query = `?robot=${encodeURIComponent(robot)}`;
  let player: Player | null = null;
  let closed = false;
  void request("GET", `/api/films/${encodeURIComponent(name)}${query}`).then(
    (film: Film & { ok: boolean; text: string }) => {
      if (closed) return;
      if (!film.ok) return fill(element, h("p", { class: "problem", lang: "en" }, film.text));
      player = new Player(film, at, (seconds) => history.replaceState(null, "", address("runs", robot, name, seconds.toFixed(1))));
      const download = h("a", { href: `/api/recordings/${encodeURIComponent(name)}${query}`, download: name }, t("runs.download"));
      const share = h("button", { type: "button", onclick: () => void navigator.clipboard.writeText(location.href) }, t("runs.share"));
      fill(element, h("div", { class: "title" }, h("h1", { dir: "auto" }, name), h("div", { class: "controls" }, share, download)), player.element);
    },
    (error: Error) => fill(element, h("p", { class: "problem", role: "alert", lang: "en" }, error.message)),
  );
  return { element, close: () => { closed = true; player?.close(); } };
}

function openList(context: Context): View {
  const list = h("ol", { class: "tasks" });
  const problem = h("p", { class: "problem", role: "alert" });
  const again = async (task: Task): Promise<void> => {
    fill(problem);
    await command(context, "again", { task: task.id }).catch((error: Error) => fill(problem, error.message));
  };
  const show = async (): Promise<void> => {
    const query = `?robot=${encodeURIComponent(context.robot)}`;
    const { recordings } = await request("GET", `/api/recordings${query}`).catch(() => ({ recordings: [] }));
    const recorded = new Map((recordings as Recording[]).map((each) => [each.task, each.name]));
    const tasks = ((await command(context, "list", { states: OVER }).catch(() => ({}) as Record<string, any>))["tasks"] ?? []) as Task[];
    fill(
      list,
      ...tasks.map((task) =>
        h(
          "li",
          { class: "card" },
          h("span", { class: "number" }, `#${task.id}`),
          h("span", { class: "what", dir: "auto" }, called(task)),
          h("span", { class: `pill ${BAD.includes(task.state) ? "bad" : task.state === "completed" ? "good" : "quiet"}` }, t(`state.${task.state}` as Key)),
          h("span", { class: "why", lang: "en", dir: "auto" }, [task.ended && moment(task.ended), task.person, task.reason].filter(Boolean).join(" · ")),
          h(
            "span",
            { class: "acts" },
            recorded.has(task.id) && h("a", { class: "button", href: address("runs", context.robot, recorded.get(task.id)!) }, t("runs.replay")),
            context.me.role !== "viewer" && h("button", { type: "button", onclick: () => void again(task) }, t("runs.again")),
          ),
        ),
      ),
    );
    if (!tasks.length) fill(list, h("li", { class: "empty" }, t("runs.none")));
  };
  void show();
  const unwatch = context.fleet.watch((robot, kind, news) => {
    if ((kind === "change" && OVER.includes(news!["state"])) || (kind === "up" && (!context.robot || robot.name === context.robot))) void show();
  });
  return { element: h("section", { class: "page" }, h("h1", {}, t("tab.runs")), problem, list), close: unwatch };
}
