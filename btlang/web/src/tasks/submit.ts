// The form for new work: words or a mission of the library, now or by a schedule.
import { fill, h } from "../dom";
import { t } from "../texts";
import type { Context } from "../view";
import { libraryOf } from "./library";
import { command } from "./queue";

/** `done` is called after the robot has taken it. */
export function submitForm(context: Context, done: () => void = () => undefined): HTMLFormElement {
  const text = h("textarea", { rows: 3, spellcheck: "false", dir: "auto", placeholder: t("submit.example") });
  const mission = h("select", {}, h("option", { value: "" }, t("submit.words")));
  const rule = h("input", { dir: "auto", placeholder: t("submit.rule.example") });
  const said = h("p", { class: "said", role: "status" });
  const problem = h("pre", { class: "problem", role: "alert" });
  const button = h("button", { class: "primary" }, t("submit"));
  const words = h("label", {}, t("submit.text"), text);
  mission.addEventListener("change", () => (words.hidden = mission.value !== ""));
  rule.addEventListener("input", () => fill(button, rule.value ? t("submit.schedule") : t("submit")));
  const form = h("form", { class: "submit" }, h("label", {}, t("submit.mission"), mission), words, h("label", {}, t("submit.rule"), rule), button, said, problem);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    button.disabled = true;
    fill(problem);
    fill(said);
    const what = mission.value ? { name: mission.value } : { text: text.value };
    try {
      const made = rule.value
        ? (await command(context, "schedule", { ...what, rule: rule.value }))["schedule"]
        : (await command(context, "submit", what))["task"];
      fill(said, rule.value ? t("submit.scheduled", { rule: (await import("./schedule")).ruleInWords(made) }) : t("submit.queued", { task: made.id }));
      text.value = rule.value = "";
      fill(button, t("submit"));
      done();
    } catch (error) {
      fill(problem, (error as Error).message);
    } finally {
      button.disabled = false;
    }
  });
  void libraryOf(context.robot).then(
    (missions) => mission.append(...missions.map(({ name }) => h("option", { value: name }, name))),
    () => undefined,
  );
  return form;
}
