// The texts of screens that few people open: texts/more.*.json, loaded with the first of these screens.
import { filled, language } from "./texts";
import en from "./texts/more.en.json";

export type MoreKey = keyof typeof en;
const OTHERS: Record<string, () => Promise<{ default: Record<string, string> }>> = {
  de: () => import("./texts/more.de.json"),
  es: () => import("./texts/more.es.json"),
};
let texts: Record<string, string> = en;

/** Loads the texts of the language of the page; where that fails, they are English. */
export async function loadMore(): Promise<void> {
  texts = (await OTHERS[language()]?.().catch(() => null))?.default ?? en;
}

/** A text in the language of the page, with `{name}` filled in. */
export function more(key: MoreKey, values: Record<string, string | number> = {}): string {
  return filled(texts[key] ?? en[key], values);
}
