// The missions of the library: read, check, keep.
import { may, request, RequestError } from "../api";
import { fill, h } from "../dom";
import { t } from "../texts";
import { address, type Context, type View } from "../view";

/** See `View`. #/write/NAME opens a mission of the library. */
export function openWrite(context: Context): View {
  const name = context.path[0] ?? "";
  const robot = `?robot=${encodeURIComponent(context.robot)}`;
  const list = h("ul", { class: "tasks" });
  const title = h("input", { value: name, dir: "auto", required: true, readonly: name !== "" });
  const text = h("textarea", { class: "mission", rows: 20, spellcheck: "false", dir: "auto", lang: "en" });
  const said = h("pre", { class: "said", role: "status", lang: "en" });
  let revision = 0;
  const attempt = async (what: () => Promise<string>): Promise<void> => {
    try {
      fill(said, await what());
    } catch (error) {
      fill(said, error instanceof RequestError && error.data.data?.diff ? `${error.message}\n${error.data.data.diff}` : (error as Error).message);
    }
  };
  const check = (): Promise<void> =>
    attempt(async () => {
      const { messages } = await request("POST", "/api/check", { text: text.value, robot: context.robot });
      return messages.length ? messages.map((each: any) => `${each.line}:${each.column}  ${each.message} ${each.hint}`).join("\n") : t("write.fine");
    });
  const keep = (): Promise<void> =>
    attempt(async () => {
      const answer = await request("PUT", `/api/missions/${encodeURIComponent(title.value)}${robot}`, { text: text.value, revision });
      revision = answer.data.mission.number;
      return answer.text;
    });
  const form = h(
    "form",
    { class: "card submit", onsubmit: (event: Event) => { event.preventDefault(); void keep(); } },
    h("label", {}, t("write.name"), title),
    h("label", {}, t("write.text"), text),
    h("div", { class: "controls" }, h("button", { type: "button", onclick: () => void check() }, t("write.check")), may(context.me, "editor") && h("button", { class: "primary" }, t("write.keep"))),
    said,
  );
  void request("GET", `/api/missions${robot}`).then(
    ({ data }) => {
      const missions = data.missions as { name: string; number: number; text: string }[];
      fill(list, ...missions.map((each) => h("li", { class: "card" }, h("a", { class: "what", href: address("write", each.name), dir: "auto" }, each.name))));
      const found = missions.find((each) => each.name === name);
      if (found) [text.value, revision] = [found.text, found.number];
    },
    (error: Error) => fill(said, error.message),
  );
  return { element: h("section", { class: "page" }, h("h1", {}, t("tab.write")), list, form), close: () => undefined };
}
