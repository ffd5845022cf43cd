// The queue of a robot and its schedules: add, reorder, cancel, remove.
import { may } from "../api";
import { fill, h } from "../dom";
import { moment, said, t, type Key } from "../texts";
import type { Context, View } from "../view";
import { called, command, Queue, type Task } from "./queue";
import { ruleInWords, type Scheduled } from "./schedule";
import { submitForm } from "./submit";

interface Schedule extends Scheduled {
  id: number;
  mission: string;
  next: number | null;
}

/** See `View`. */
export function openTasks(context: Context): View {
  const operates = may(context.me, "operator");
  const problem = h("p", { class: "problem", role: "alert" });
  const list = h("ol", { class: "tasks" });
  const schedules = h("ul", { class: "tasks" });
  const act = async (name: string, fields: Record<string, unknown>): Promise<void> => {
    fill(problem);
    try {
      await command(context, name, fields);
    } catch (error) {
      fill(problem, (error as Error).message);
    }
    await Promise.all([listSchedules(), queue.ask()]); // a new order is no change of a task
  };
  const button = (key: Key, run: () => Promise<void>, what: string): HTMLElement =>
    h("button", { type: "button", "aria-label": `${t(key)}: ${what}`, onclick: () => void run() }, t(key));
  const line = (task: Task, before: Task | undefined): HTMLElement => {
    const begun = ["underway", "standby"].includes(task.state);
    return h(
      "li",
      { class: "card" },
      h("span", { class: "number" }, `#${task.id}`),
      h("span", { class: "what", dir: "auto" }, called(task)),
      h("span", { class: `pill ${begun ? "good" : task.state === "blocked" ? "bad" : "quiet"}` }, t(`state.${task.state}` as Key)),
      h("span", { class: "why", dir: "auto" }, [said(task.waits || task.reason), task.person].filter(Boolean).join(" · ")),
      operates && h(
        "span", { class: "acts" },
        !begun && before && !["underway", "standby"].includes(before.state) && button("tasks.earlier", () => act("reorder", { task: task.id, before: before.id }), task.mission),
        button("cancel", () => act("cancel", { task: task.id }), task.mission),
      ),
    );
  };
  const queue = new Queue(context, () => {
    fill(list, ...queue.tasks.map((task, index) => line(task, queue.tasks[index - 1])));
    if (!queue.tasks.length) fill(list, h("li", { class: "empty" }, t("tasks.none")));
  });
  const listSchedules = async (): Promise<void> => {
    const found = ((await command(context, "schedules").catch(() => ({}) as Record<string, any>))["schedules"] ?? []) as Schedule[];
    fill(
      schedules,
      ...found.map((each) =>
        h(
          "li",
          { class: "card" },
          h("span", { class: "what", dir: "auto" }, called(each)),
          h("span", { class: "pill quiet" }, ruleInWords(each)),
          h("span", { class: "why" }, each.next === null ? "" : t("tasks.next", { time: moment(each.next) })),
          operates && h("span", { class: "acts" }, button("tasks.remove", () => act("unschedule", { schedule: each.id }), each.mission)),
        ),
      ),
    );
    if (!found.length) fill(schedules, h("li", { class: "empty" }, t("tasks.unscheduled")));
  };
  void listSchedules();
  const element = h(
    "section",
    { class: "page" },
    h("h1", {}, t("tab.tasks")),
    operates && h("details", { class: "card", open: true }, h("summary", {}, t("submit.title")), submitForm(context, () => void listSchedules())),
    problem,
    h("h2", {}, t("tasks.queue")),
    list,
    h("h2", {}, t("tasks.schedules")),
    schedules,
  );
  return { element, close: () => queue.close() };
}
