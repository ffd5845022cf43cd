// Changes of users, with the questions before them and the secrets after them.
import { post, RequestError, ROLES } from "../api";
import { fill, h } from "../dom";
import { more, type MoreKey } from "../more_texts";
import { t, visible } from "../texts";
import { ask, show } from "../write/ask";

const CONFIRM = "confirm"; // the server's code: the password was given too long ago

/** `done` is called after each change, `failed` where there's no dialog to say what went wrong. */
export class Changes {
  constructor(
    private me: string,
    private done: () => Promise<void>,
    private failed: (error: Error) => void,
  ) {}

  addUser(): void {
    const roles = ROLES.map((role) => ({ value: role, label: t(`role.${role}`) }));
    this.ask("users.add", [{ name: "name", label: t("login.name"), required: true }, { name: "role", label: more("users.role_of"), options: roles }], async ({ name, role }) => {
      const { password } = await this.change({ act: "add", name, role });
      return () => showSecret(more("users.added", { name: visible(name!) }), more("users.password_once"), password);
    });
  }

  setPassword(name: string): void {
    this.ask("users.password", [], async () => {
      const { password } = await this.change({ act: "password", name });
      return () => showSecret(more("users.password_of", { name: visible(name) }), more("users.password_once"), password);
    }, more("users.password_why", { name: visible(name) }));
  }

  remove(name: string): void {
    this.ask("users.remove", [], () => this.change({ act: "remove", name }), more("users.remove_why", { name: visible(name) }));
  }

  addToken(name: string): void {
    this.ask("tokens.add", [{ name: "token", label: more("tokens.name"), required: true }], async ({ token }) => {
      const made = await this.change({ act: "token", name, token });
      return () => showSecret(more("tokens.added", { name: visible(token!) }), more("tokens.once"), made.token);
    }, more("tokens.why", { name: visible(name) }));
  }

  /** `after` gets the focus on, because the button of the token is gone. */
  revoke(name: string, token: string, after: () => void): void {
    const asked = this.ask("tokens.revoke", [], () => this.change({ act: "revoke", name, token }), more("tokens.revoke_why", { name: visible(token) }));
    asked.addEventListener("close", () => document.activeElement === document.body && after());
  }

  async setRole(name: string, role: string): Promise<void> {
    await this.attempt({ act: "role", name, role });
  }

  async logOut(name: string): Promise<void> {
    await this.attempt({ act: "logout", name });
  }

  private async attempt(change: Record<string, string>): Promise<void> {
    try {
      await this.change(change);
    } catch (error) {
      await this.done(); // the role is shown as it is
      this.failed(error as Error);
    }
  }

  /** Asks, and does it. A function that this returns is called once the dialog is closed, which has given the focus back. */
  private ask(title: MoreKey, fields: Parameters<typeof ask>[1], does: (values: Record<string, string>) => Promise<unknown>, why = ""): HTMLDialogElement {
    let after: unknown;
    const run = async (values: Record<string, string>): Promise<string> => {
      try {
        after = await does(values);
        return "";
      } catch (error) {
        return visible((error as Error).message);
      }
    };
    const asked = ask(more(title), fields, run, more(title).replace(/ …$/, ""), why);
    asked.addEventListener("close", () => typeof after === "function" && after());
    return asked;
  }

  /** Asks for the password if the server wants it, and then tries again. Throws RequestError. */
  private async change(change: Record<string, string | undefined>): Promise<any> {
    try {
      return await this.send(change);
    } catch (error) {
      if (!(error instanceof RequestError && error.data.code === CONFIRM && (await this.confirm()))) throw error;
      return this.send(change);
    }
  }

  private async send(change: Record<string, string | undefined>): Promise<any> {
    const answer = await post("/api/users", change);
    await this.done();
    return answer;
  }

  /** Whether the right password was given. */
  private confirm(): Promise<boolean> {
    return new Promise((resolve) => {
      let right = false;
      const password = { name: "password", label: t("login.password"), required: true, type: "password", autocomplete: "current-password" } as const;
      const asked = ask(more("confirm"), [password], async ({ password }) => {
        try {
          await post("/api/confirm", { password });
          right = true;
          return "";
        } catch (error) {
          return (error as Error).message;
        }
      }, t("ok"), more("confirm.why", { name: visible(this.me) }));
      asked.addEventListener("close", () => resolve(right));
    });
  }
}

/** Shows what the server says only once. */
function showSecret(title: string, why: string, secret: string): void {
  const copied = h("p", { role: "status" });
  const copy = async (): Promise<void> => {
    await navigator.clipboard.writeText(secret).then(() => fill(copied, more("copied")), () => undefined);
  };
  const dialog = show(
    title, h("p", {}, why), h("p", { class: "secret" }, h("code", {}, secret)), copied,
    h("div", { class: "controls" }, h("button", { type: "button", class: "primary", onclick: () => void copy() }, more("copy")), h("button", { type: "button", onclick: () => dialog.close() }, more("close"))),
  );
}
