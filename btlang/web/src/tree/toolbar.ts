// What is above a tree: search, folds, zoom, direction.
import { fill, h, s } from "../dom";
import { t, type Key } from "../texts";
import type { TreeCanvas } from "./tree_canvas";

export function toolbar(view: TreeCanvas): HTMLElement {
  const count = h("output", { class: "count" });
  const search = h("input", { type: "search", placeholder: t("tree.search"), "aria-label": t("tree.search"), dir: "auto" });
  let found: number[] = [];
  let at = -1;
  const next = (step: number): void => {
    if (!found.length) return;
    at = (at + step + found.length) % found.length;
    view.pick(found[at]!);
    fill(count, `${at + 1}/${found.length}`);
  };
  search.addEventListener("input", () => {
    found = view.find(search.value);
    at = -1;
    fill(count, search.value ? t("tree.found", { count: found.length }) : "");
  });
  search.addEventListener("keydown", (event) => {
    if (event.key === "Enter") next(event.shiftKey ? -1 : 1);
    if (event.key === "Escape") view.scroll.focus();
  });
  const button = (key: Key, shape: string, run: () => void): HTMLElement =>
    h("button", { type: "button", title: t(key), "aria-label": t(key), onclick: run }, s("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, s("path", { d: shape })));
  const details = h("button", { type: "button", "aria-pressed": "false", onclick: () => {
    view.details = !view.details;
    details.setAttribute("aria-pressed", String(view.details));
  } }, t("tree.details"));
  return h(
    "div",
    { class: "toolbar", role: "group", "aria-label": t("tree.tools") },
    search, count, details,
    button("tree.turn", "M3 6V3h10M10 1l3 2-3 2M13 10v3H3M6 11l-3 2 3 2", () => view.turn()),
    button("tree.fold", "M2 2h12v12H2zM5 8h6", () => view.foldAll()),
    button("tree.unfold", "M2 2h12v12H2zM5 8h6M8 5v6", () => view.unfoldAll()),
    button("tree.smaller", "M3 8h10", () => view.zoomBy(1 / 1.25)),
    button("tree.larger", "M3 8h10M8 3v10", () => view.zoomBy(1.25)),
    button("tree.fit", "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4", () => view.fit()),
  );
}
