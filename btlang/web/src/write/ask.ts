// Questions in the middle of the screen: a dialog with fields, closed by Escape.
import { fill, h } from "../dom";
import { t } from "../texts";

/** `options` makes it a choice; an empty text is refused where it is `required`; a `value` may follow the other fields until it is changed. */
export interface Field {
  name: string;
  label: string;
  value?: string | ((values: Record<string, string>) => string);
  options?: { value: string; label: string }[];
  required?: boolean;
  number?: { min: number; max: number };
  type?: "date" | "time" | "password";
  autocomplete?: "current-password";
  shown?: (values: Record<string, string>) => boolean;
}

/** Asks, and does what is to be done with the answers; what goes wrong with that is said in the dialog, which stays.
 *  `why` is said above the fields.
 */
export function ask(title: string, fields: Field[], does: (values: Record<string, string>) => Promise<string>, verb = t("ok"), why = ""): HTMLDialogElement {
  const inputs = new Map<string, HTMLInputElement | HTMLSelectElement>();
  const labels = new Map<string, HTMLElement>();
  for (const field of fields) {
    const props = { name: field.name, dir: "auto", required: field.required ?? false };
    const input = field.options
      ? h("select", props, ...field.options.map(({ value, label }) => h("option", { value, selected: value === field.value }, label)))
      : h("input", { ...props, value: typeof field.value === "string" ? field.value : "", autocomplete: field.autocomplete ?? "off", type: field.type, ...(field.number ? { type: "number", ...field.number } : {}) });
    inputs.set(field.name, input);
    labels.set(field.name, h("label", {}, field.label, input));
  }
  const problem = h("p", { class: "problem", role: "alert" });
  const values = (): Record<string, string> => Object.fromEntries([...inputs].map(([name, input]) => [name, input.value]));
  const changed = new Set<EventTarget>();
  const update = (event?: Event): void => {
    if (event?.target) changed.add(event.target);
    for (const field of fields) {
      const input = inputs.get(field.name)!;
      if (typeof field.value === "function" && !changed.has(input)) input.value = field.value(values());
      const shown = field.shown?.(values()) ?? true;
      labels.get(field.name)!.hidden = !shown;
      input.disabled = !shown;
    }
  };
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    fill(problem);
    const wrong = await does(values());
    if (wrong) fill(problem, wrong);
    else dialog.close();
  };
  const dialog = show(
    title,
    h(
      "form",
      { class: "ask", onsubmit: (event: Event) => void submit(event), oninput: update },
      why && h("p", {}, why),
      ...labels.values(),
      problem,
      h("div", { class: "controls" }, h("button", { class: "primary" }, verb), h("button", { type: "button", onclick: () => dialog.close() }, t("cancel"))),
    ),
  );
  update();
  inputs.get(fields[0]?.name ?? "")?.focus();
  return dialog;
}

/** A dialog with something in it. */
export function show(title: string, ...content: HTMLElement[]): HTMLDialogElement {
  const before = document.activeElement as HTMLElement | null;
  const dialog = h("dialog", { "aria-label": title, class: "dialog" }, h("h2", { dir: "auto" }, title), ...content);
  dialog.addEventListener("close", () => {
    dialog.remove();
    before?.focus();
  });
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}
