// A film in the middle of the screen.
import { h } from "../dom";
import { Player, type Film } from "../look_back/player";
import { t } from "../texts";
import { show } from "./ask";

/** Until somebody closes it. */
export function play(title: string, film: Film): void {
  const player = new Player(film);
  const dialog = show(title, player.element, h("div", { class: "controls" }, h("button", { type: "button", onclick: () => dialog.close() }, t("close"))));
  dialog.addEventListener("close", () => player.close());
}
