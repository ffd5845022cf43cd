// The question when a mission of the library is to be done: once, every day, or by a rule in words.
import { t, type Key } from "../texts";
import type { Context } from "../view";
import { ask } from "../write/ask";
import { command } from "./queue";
import { ruleInWords } from "./rule_words";

const DAY = 86_400_000; // milliseconds
const FIRST = "09:00";

/** `done` gets the rule that the robot has taken. Times are those of this computer's time zone. */
export function askSchedule(context: Context, name: string, done: (rule: string) => void): void {
  const when = (...wanted: string[]) => (values: Record<string, string>): boolean => wanted.includes(values["when"] ?? "");
  const rules: Record<string, (values: Record<string, string>) => string> = {
    once: ({ day, time }) => `on ${day} at ${time}`,
    daily: ({ time }) => `every day at ${time}`,
    rule: ({ rule }) => rule ?? "",
  };
  ask(
    t("schedule.title", { mission: name }),
    [
      { name: "when", label: t("schedule.when"), value: "once", options: Object.keys(rules).map((value) => ({ value, label: t(`schedule.${value}` as Key) })) },
      { name: "day", label: t("schedule.day"), value: tomorrow(), type: "date", required: true, shown: when("once") },
      { name: "time", label: t("schedule.time"), value: FIRST, type: "time", required: true, shown: when("once", "daily") },
      { name: "rule", label: t("schedule.words"), value: t("submit.rule.example"), required: true, shown: when("rule") },
    ],
    async (values) => {
      const zone = Intl.DateTimeFormat().resolvedOptions().timeZone;
      try {
        const { schedule } = await command(context, "schedule", { name, rule: rules[values["when"]!]!(values), zone });
        done(ruleInWords(schedule));
        return "";
      } catch (error) {
        return (error as Error).message;
      }
    },
    t("submit.schedule"),
  );
}

/** As a field for days has it. */
function tomorrow(): string {
  return new Date(Date.now() + DAY).toLocaleDateString("sv");
}
