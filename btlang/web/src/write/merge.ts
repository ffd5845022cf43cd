// Two versions of a mission side by side, where somebody else saved in between.
import { MergeView } from "@codemirror/merge";
import { EditorState } from "@codemirror/state";
import { EditorView, lineNumbers } from "@codemirror/view";

import { h } from "../dom";
import { t } from "../texts";
import { show } from "./ask";
import { mayStyle } from "./editor";
import type { Kept } from "./store";

/** Shows both; `take` gets the text that somebody made of them, and what it is made from. */
export function merge(reason: string, theirs: Kept, mine: string, take: (text: string, from: Kept) => void): void {
  const common = [mayStyle(), EditorView.lineWrapping, lineNumbers()];
  const place = h("div", { class: "merge" });
  const dialog = show(
    t("write.stale"),
    h("p", {}, reason),
    h("p", {}, t("write.merge_help")),
    place,
    h(
      "div",
      { class: "controls" },
      h("button", { type: "button", class: "primary", onclick: () => { take(view.b.state.doc.toString(), theirs); dialog.close(); } }, t("write.take_merged")),
      h("button", { type: "button", onclick: () => { take(theirs.text, theirs); dialog.close(); } }, t("write.take_theirs")),
      h("button", { type: "button", onclick: () => dialog.close() }, t("cancel")),
    ),
  );
  const label = (text: string) => EditorView.contentAttributes.of({ "aria-label": text });
  const view = new MergeView({
    parent: place,
    a: { doc: theirs.text, extensions: [...common, EditorState.readOnly.of(true), label(t("write.theirs"))] },
    b: { doc: mine, extensions: [...common, label(t("write.mine"))] },
    revertControls: "a-to-b",
    highlightChanges: true,
  });
  dialog.addEventListener("close", () => view.destroy());
}
