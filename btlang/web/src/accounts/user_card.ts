// A user: the role, the tokens, and what can be done about them.
import { ROLES, type Role } from "../api";
import { fill, h } from "../dom";
import { more, type MoreKey } from "../more_texts";
import { moment, visible } from "../texts";
import type { Changes } from "./changes";

/** Times are in seconds since 1970. */
export interface User {
  name: string;
  role: Role;
  created: number;
  tokens: { name: string; created: number; used: number | null }[];
}

/** `own` is the account of who is logged in, which can't be changed here but for its tokens. */
export class UserCard {
  readonly element: HTMLElement;
  private since = h("small");
  private role: HTMLSelectElement;
  private summary = h("summary");
  private tokens = h("ul", { class: "tokens" });
  private add: HTMLElement;

  constructor(
    private name: string,
    own: boolean,
    private changes: Changes,
  ) {
    const options = ROLES.map((role) => h("option", { value: role }, more(`role.${role}`)));
    this.role = h("select", { "aria-label": more("users.role", { name: visible(name) }), disabled: own, onchange: () => void changes.setRole(name, this.role.value) }, ...options);
    this.add = this.button("tokens.add", () => changes.addToken(name));
    this.element = h(
      "li", { class: "card" },
      h("strong", { dir: "auto" }, visible(name), own && h("small", {}, ` ${more("users.you")}`), " ", this.since),
      this.role,
      h("div", { class: "controls" }, ...(own ? [] : [
        this.button("users.password", () => changes.setPassword(name)),
        this.button("users.logout", () => void changes.logOut(name)),
        this.button("users.remove", () => changes.remove(name)),
      ])),
      h("details", {}, this.summary, this.tokens, this.add),
    );
  }

  show({ role, created, tokens }: User): void {
    this.role.value = role;
    fill(this.since, more("users.since", { time: moment(created) }));
    fill(this.summary, more("tokens", { count: tokens.length }));
    fill(this.tokens, ...tokens.map(({ name, used }) => h(
      "li", {},
      h("span", { dir: "auto" }, visible(name)),
      h("small", {}, used === null ? more("tokens.unused") : more("tokens.used", { time: moment(used) })),
      this.button("tokens.revoke", () => this.changes.revoke(this.name, name, () => this.add.focus()), name),
    )));
  }

  private button(key: MoreKey, run: () => void, of = this.name): HTMLElement {
    return h("button", { type: "button", "aria-label": `${more(key)}: ${visible(of)}`, onclick: run }, more(key));
  }
}
