// Schedules: the question when a mission of the library is to be done, and when it is due, in the language of the page.
import { language, locale, t, type Key } from "../texts";
import type { Context } from "../view";
import { ask } from "../write/ask";
import { command } from "./queue";

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

/** See `Rule` and `Days` in btlang/task/schedule/calendar.py. */
export interface Scheduled {
  rule: string;
  zone: string;
  plan: {
    days: { weekdays: number[]; which: number[]; month_days: number[]; single: number[] };
    times: number[];
    interval: number;
    window: number[];
  };
}

const NAMED: Record<string, Key> = { "0,1,2,3,4,5,6": "rule.daily", "0,1,2,3,4": "rule.workdays", "5,6": "rule.weekend" };
const UNITS = [["hour", 3600], ["minute", 60], ["second", 1]] as const;

/** The rule with its time zone. */
export function ruleInWords({ rule, zone, plan }: Scheduled): string {
  return [language() === "en" ? rule : planInWords(plan), zone].filter(Boolean).join(", ");
}

function planInWords({ days, times, interval, window }: Scheduled["plan"]): string {
  const said = daysInWords(days);
  if (times.length) return t("rule.at", { days: said, times: listed(times.map(clock)) });
  const [unit, length] = UNITS.find(([, length]) => interval % length === 0)!;
  const every = new Intl.NumberFormat(locale(), { style: "unit", unit, unitDisplay: "long" }).format(interval / length);
  const [start, end] = window.map(clock);
  return [t("rule.every", { interval: every }), start && t("rule.between", { start, end: end! }), said !== t("rule.daily") && said].filter(Boolean).join(" ");
}

function daysInWords({ weekdays, which, month_days, single }: Scheduled["plan"]["days"]): string {
  if (single.length) {
    const [year, month, day] = single as [number, number, number];
    const date = dated(new Date(Date.UTC(year || 2000, month - 1, day)), { day: "numeric", month: "long", ...(year ? { year: "numeric" } : {}) });
    return t(year ? "rule.once" : "rule.yearly", { day: date });
  }
  const nth = (key: Key, numbers: number[]): string => listed(numbers.map((number) => (number < 0 ? t("rule.last") : t(key, { number }))));
  if (month_days.length) return t("rule.month_days", { days: nth("rule.day", month_days) });
  if (which.length) return t("rule.which", { which: nth("rule.nth", which), weekday: weekday(weekdays[0]!) });
  const named = NAMED[String(weekdays)];
  if (named) return t(named);
  const left = [0, 1, 2, 3, 4, 5, 6].filter((day) => !weekdays.includes(day));
  return left.length === 1 ? t("rule.except", { day: weekday(left[0]!) }) : t("rule.weekdays", { days: listed(weekdays.map(weekday)) });
}

const dated = (date: Date, parts: Intl.DateTimeFormatOptions): string => new Intl.DateTimeFormat(locale(), { ...parts, timeZone: "UTC" }).format(date);
const weekday = (day: number): string => dated(new Date(Date.UTC(2024, 0, 1 + day)), { weekday: "long" }); // a Monday, and what follows it
const listed = (words: string[]): string => new Intl.ListFormat(locale(), { type: "conjunction" }).format(words);

function clock(seconds: number): string {
  const parts = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, ...(seconds % 60 ? [seconds % 60] : [])];
  return parts.map((part) => String(part).padStart(2, "0")).join(":");
}
