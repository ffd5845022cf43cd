// Small helpers to make elements. Texts are always text nodes: nothing that comes from outside is read as markup.

export type Child = Node | string | number | null | undefined | false;
type Props = Record<string, unknown>;

/** An HTML element: `on...` are listeners, other functions and objects properties, the rest attributes. */
export function h<K extends keyof HTMLElementTagNameMap>(tag: K, props: Props = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  set(element, props);
  append(element, children);
  return element;
}

/** An SVG element. */
export function s<K extends keyof SVGElementTagNameMap>(tag: K, props: Props = {}, ...children: Child[]): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  set(element, props);
  append(element, children);
  return element;
}

/** Changes attributes; null, undefined and false take them away. */
export function set(element: Element, props: Props): void {
  for (const [name, value] of Object.entries(props)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value as EventListener);
    else if (value === null || value === undefined || value === false) element.removeAttribute(name);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
}

/** Replaces what is in an element. */
export function fill(element: Element, ...children: Child[]): void {
  element.replaceChildren(...present(children));
}

function append(element: Element, children: Child[]): void {
  element.append(...present(children));
}

function present(children: Child[]): (Node | string)[] {
  return children.flatMap((each) => (each === null || each === undefined || each === false ? [] : [typeof each === "number" ? String(each) : each]));
}

/** Calls `draw` once before the next picture, however often it is asked for. */
export function oncePerFrame(draw: () => void): () => void {
  let asked = 0;
  return () => {
    asked ||= requestAnimationFrame(() => {
      asked = 0;
      draw();
    });
  };
}

/** A line of a menu. */
export interface MenuItem {
  label: string;
  run: () => void;
}

/** A button that opens a menu below it. */
export function menuButton(label: string, items: () => MenuItem[]): HTMLElement {
  const button = h("button", { type: "button", "aria-haspopup": "menu" }, label);
  button.addEventListener("click", () => {
    const { left, bottom } = button.getBoundingClientRect();
    openMenu(left, bottom + 4, label, items());
  });
  return button;
}

/** A list of commands at a point of the window, closed by a click elsewhere, by Escape, or by a choice. */
export function openMenu(x: number, y: number, label: string, items: MenuItem[]): void {
  const before = document.activeElement as HTMLElement | null;
  const menu = h("div", { class: "menu", role: "menu", popover: "manual", "aria-label": label });
  // not the browser's own dismissal: it takes the end of a right click for one elsewhere
  const elsewhere = (event: Event): void => {
    if (!menu.contains(event.target as Node)) close();
  };
  const close = () => {
    removeEventListener("pointerdown", elsewhere, true);
    menu.remove();
    before?.focus();
  };
  const buttons = items.map(({ label, run }) =>
    h("button", { type: "button", role: "menuitem", tabindex: -1, onclick: () => { close(); run(); } }, label),
  );
  menu.append(...buttons);
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape" || event.key === "Tab") {
      event.preventDefault();
      return close();
    }
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
    buttons[(at + step + buttons.length) % buttons.length]?.focus();
  });
  addEventListener("pointerdown", elsewhere, true);
  document.body.append(menu);
  menu.showPopover();
  menu.style.left = `${Math.max(8, Math.min(x, innerWidth - menu.offsetWidth - 8))}px`;
  menu.style.top = `${Math.max(8, Math.min(y, innerHeight - menu.offsetHeight - 8))}px`;
  buttons[0]?.focus();
}
