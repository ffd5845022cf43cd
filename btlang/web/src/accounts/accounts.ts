// Users, their tokens, and the trail of what people did: the screen of administrators.
import { request, RequestError } from "../api";
import { fill, h } from "../dom";
import { addStyle } from "../late_style";
import { loadMore, more } from "../more_texts";
import { t, visible } from "../texts";
import type { Open, View } from "../view";
import { Changes } from "./changes";
import style from "./style.css" with { type: "text" };
import { Trail } from "./trail";
import { UserCard, type User } from "./user_card";

/** Loads the texts first, so that the screen is drawn once. */
export async function accountsOpener(): Promise<Open> {
  await loadMore();
  addStyle(style);
  return ({ me }) => new AccountsView(me.user);
}

class AccountsView implements View {
  readonly element: HTMLElement;
  private problem = h("p", { class: "problem", role: "alert" });
  private list = h("ul", { class: "users" });
  private cards = new Map<string, UserCard>();
  private trail = new Trail((error) => this.fail(error));
  private changes: Changes;

  constructor(private me: string) {
    this.changes = new Changes(me, () => this.refresh(), (error) => this.fail(error));
    const add = h("button", { type: "button", class: "primary", onclick: () => this.changes.addUser() }, more("users.add"));
    this.element = h(
      "section", { class: "page accounts" },
      h("div", { class: "title" }, h("h1", {}, t("tab.accounts")), add),
      this.problem, this.list, this.trail.element,
    );
    void this.refresh();
  }

  close(): void {
    this.trail.close();
  }

  private async refresh(): Promise<void> {
    fill(this.problem);
    try {
      const { users } = (await request("GET", "/api/users")) as { users: User[] };
      for (const user of users) {
        if (!this.cards.has(user.name)) this.cards.set(user.name, new UserCard(user.name, user.name === this.me, this.changes));
        this.cards.get(user.name)!.show(user);
      }
      const elements = users.map(({ name }) => this.cards.get(name)!.element);
      // only if somebody came or went: what is taken out and put in again loses the focus
      if (elements.length !== this.list.children.length || elements.some((each, index) => each !== this.list.children[index])) fill(this.list, ...elements);
      for (const name of [...this.cards.keys()]) if (!users.some((user) => user.name === name)) this.cards.delete(name);
    } catch (error) {
      if (error instanceof RequestError && error.status === 403) return this.hide(error); // no administrator any more
      this.fail(error as Error);
    }
    await this.trail.refresh();
  }

  private hide(error: Error): void {
    this.trail.close();
    this.element.replaceChildren(this.problem);
    this.fail(error);
  }

  private fail(error: Error): void {
    fill(this.problem, visible(error.message));
  }
}
