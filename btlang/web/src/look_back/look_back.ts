// What the robots did: the tasks that are over, newest first.
import { fill, h } from "../dom";
import { called, command, type Task } from "../tasks/queue";
import { moment, t, type Key } from "../texts";
import type { Context, View } from "../view";

const OVER = ["completed", "failed", "canceled", "killed", "error", "skipped"];
const BAD = ["failed", "killed", "error"];

/** See `View`. */
export function openLookBack(context: Context): View {
  const list = h("ol", { class: "tasks" });
  const problem = h("p", { class: "problem", role: "alert" });
  const again = async (task: Task): Promise<void> => {
    fill(problem);
    await command(context, "again", { task: task.id }).catch((error: Error) => fill(problem, error.message));
  };
  const show = async (): Promise<void> => {
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
          context.me.role !== "viewer" && h("span", { class: "acts" }, h("button", { type: "button", onclick: () => void again(task) }, t("runs.again"))),
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
