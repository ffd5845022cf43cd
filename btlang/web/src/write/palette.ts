// What can be added: the words of the robot by topic, joining forms, and own definitions.
import { fill, h } from "../dom";
import { addStyle } from "../late_style";
import { t } from "../texts";
import { show } from "./ask";
import style from "./palette.css" with { type: "text" };
import type { Reader } from "./understood";

interface Offer {
  words: string;
  help: string;
  example: string;
  sort: string;
  insert: string;
}

/** Lets somebody choose, or write, a command or a condition; `add` gives what is wrong with it, "" for nothing. */
export async function choose(reader: Reader, text: string, conditions: boolean, add: (words: string) => Promise<string>): Promise<void> {
  addStyle(style);
  const answer = await reader.service("palette", text, {});
  const topics = ((answer.topics ?? []) as { topic: string; items: Offer[] }[]).map(({ topic, items }) => ({
    topic,
    items: items.filter(({ sort, insert }) => insert && (sort === "name" || conditions === (sort === "condition"))),
  }));
  const problem = h("p", { class: "problem", role: "alert" });
  const input = h("input", { type: "text", dir: "auto", lang: "en", autocomplete: "off", "aria-label": t("write.words"), placeholder: t("write.words") });
  const list = h("div", { class: "palette", lang: "en" });
  const done = async (words: string): Promise<void> => {
    fill(problem);
    const wrong = words.trim() ? await add(words) : t("write.words_missing");
    if (wrong) fill(problem, wrong);
    else dialog.close();
  };
  const filter = (): void => {
    const wanted = input.value.trim().toLowerCase();
    const parts = topics.flatMap(({ topic, items }) => {
      const found = items.filter(({ words, help }) => !wanted || `${words} ${help} ${topic}`.toLowerCase().includes(wanted));
      if (!found.length) return [];
      const offers = found.map(({ words, help, insert }) =>
        h("button", { type: "button", class: "offer", title: help, onclick: () => take(insert) }, h("span", { dir: "auto" }, words), help && h("small", {}, help)),
      );
      return [h("section", {}, h("h3", {}, topic), h("div", { class: "offers" }, ...offers))];
    });
    fill(list, ...parts);
  };
  /** Values that are only examples are there to be changed. */
  const take = (insert: string): void => {
    input.value = insert;
    input.focus();
    const first = insert.search(/\S+$/);
    input.setSelectionRange(first > 0 ? first : 0, insert.length);
  };
  input.addEventListener("input", filter);
  const form = h(
    "form",
    { class: "adding", onsubmit: (event: Event) => { event.preventDefault(); void done(input.value); } },
    input,
    h("button", { class: "primary" }, t("write.add")),
  );
  const dialog = show(t(conditions ? "write.add_condition" : "write.add_step"), form, problem, list);
  filter();
  input.focus();
}
