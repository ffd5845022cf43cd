// What is wrong with a text, as a list: each message with its line, which is the way there, and a button for each fix.
import { h } from "../dom";
import { t } from "../texts";
import type { Editor } from "./editor";
import type { Message } from "./understood";

/** The items of the list; without messages one that says so. `mayFix` is whether fixes are offered. */
export function messageList(messages: Message[], editor: Editor, mayFix = true): HTMLElement[] {
  const item = (each: Message): HTMLElement =>
    h(
      "li",
      { class: each.severity },
      h("button", { type: "button", class: "go", title: each.code, onclick: () => editor.go(each.start) }, h("b", {}, t("write.line", { line: editor.lineAt(each.start) })), ` ${each.message}`, each.hint && h("small", {}, each.hint)),
      ...(mayFix ? editor.fixes(each) : []).map(({ name, apply }) => h("button", { type: "button", class: "fix", dir: "auto", onclick: () => { apply(editor.view, each.start, each.end); editor.view.focus(); } }, name)),
    );
  return messages.length ? messages.map(item) : [h("li", { class: "fine" }, t("write.fine"))];
}
