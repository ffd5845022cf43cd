// The house rules round a mission: one quiet line for each, with what it does now.
import { fill, h } from "../dom";
import type { Rule, Status } from "../fleet";
import { t } from "../texts";

export type RuleState = "doing" | "armed" | "waiting";

/** What each rule does: it's armed while it looks, and waits where nothing runs or a more important one acts. */
export function ruleStates(rules: readonly Rule[], statuses: readonly Status[]): RuleState[] {
  return rules.map(([node, does]) => (statuses[does] === "RUNNING" ? "doing" : statuses[node] === "RUNNING" ? "armed" : "waiting"));
}

export class RuleStrip {
  private list = h("ul", {});
  readonly element = h("div", { class: "rules", role: "group", "aria-label": t("rules"), hidden: true }, h("h2", {}, t("rules")), this.list);
  private shown = "";

  /** `choose` shows a rule in the tree. */
  constructor(private choose: (rule: Rule) => void) {}

  show(rules: readonly Rule[], statuses: readonly Status[]): void {
    const states = ruleStates(rules, statuses);
    const shown = JSON.stringify([rules, states]);
    if (shown === this.shown) return;
    this.shown = shown;
    this.element.hidden = !rules.length;
    fill(
      this.list,
      ...rules.map((rule, index) =>
        h("li", { class: states[index] }, h("button", { type: "button", title: t("rules.show"), onclick: () => this.choose(rule) }, h("b", {}, t(`rules.${states[index]!}`)), " ", h("span", { dir: "auto" }, rule[2]))),
      ),
    );
  }
}
