// All words that people see are in texts/*.json; this chooses the language and fills in names and numbers.
import en from "./texts/en.json";

export type Key = keyof typeof en;
/** The languages with their own names. Others than English are loaded where they are chosen: see translations.ts. */
export const languages: [string, string][] = [["en", "English"], ["de", "Deutsch"], ["es", "Español"]];
const KEPT = "btlang.language";
let texts: Record<string, string> = en;
/** What a server or robot says in English, in the language of the page as far as its sentences are known. */
export let said = (english: string): string => english;

/** Loads the texts of the language of the page; until then, and where that fails, they are English. */
export async function loadTexts(): Promise<void> {
  const name = language();
  const found = name === "en" ? null : await import("./translations").then(({ load }) => load(name)).catch(() => null);
  [texts, said] = found ?? [en, (english) => english];
}

/** The language of the page: the chosen one, else the browser's, else English. */
export function language(): string {
  const wanted = localStorage.getItem(KEPT) ?? navigator.language.slice(0, 2);
  return languages.some(([name]) => name === wanted) ? wanted : "en";
}

/** Keeps the language; the page has to be drawn again. */
export function setLanguage(name: string): void {
  localStorage.setItem(KEPT, name);
}

/** The texts that there are, in their order. */
export const KEYS = Object.keys(en) as Key[];

/** A text in the language of the page, with `{name}` filled in. */
export function t(key: Key, values: Record<string, string | number> = {}): string {
  return filled(texts[key] ?? en[key], values);
}

/** A text with `{name}` filled in. */
export function filled(text: string, values: Record<string, string | number>): string {
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

/** How people here write times, in the language of the page. */
export function locale(): string {
  const valid = /^[\w-]+$/; // Chromium says "en-US@posix" where the system has no language
  return navigator.languages.find((each) => each.startsWith(language()) && valid.test(each)) ?? language();
}

/** A moment, given in seconds since 1970: the time, with the day if that isn't today. */
export function moment(seconds: number): string {
  const date = new Date(seconds * 1000);
  const time = date.toLocaleTimeString(locale(), { hour: "2-digit", minute: "2-digit", second: "2-digit" });
  if (date.toDateString() === new Date().toDateString()) return time;
  return `${date.toLocaleDateString(locale(), { weekday: "short", day: "numeric", month: "short" })} ${time.slice(0, 5)}`;
}

/** A text from outside, in which characters that only control how others are shown are seen. */
export function visible(text: string): string {
  return text.replace(/[\u0000-\u001f\u007f-\u009f\u200e\u200f\u202a-\u202e\u2066-\u2069]/g, "\ufffd");
}
