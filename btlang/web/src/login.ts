// The log-in.
import { logIn, RequestError } from "./api";
import { fill, h } from "./dom";
import { t } from "./texts";

/** Calls `done` once somebody is logged in. */
export function showLogin(done: () => void): void {
  const problem = h("p", { class: "problem", role: "alert" });
  const button = h("button", { class: "primary" }, t("login"));
  const name = h("input", { name: "name", autocomplete: "username", required: true, dir: "auto" });
  const password = h("input", { name: "password", type: "password", autocomplete: "current-password", required: true });
  const form = h(
    "form",
    { class: "card login" },
    h("h1", {}, "btlang"),
    h("label", {}, t("login.name"), name),
    h("label", {}, t("login.password"), password),
    button,
    problem,
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    button.disabled = true;
    fill(problem);
    try {
      await logIn(name.value, password.value);
      done();
    } catch (error) {
      const answered = error instanceof RequestError && error.status > 0;
      fill(problem, answered ? error.message : t("offline"));
      button.disabled = false;
    }
  });
  fill(document.body, h("main", { class: "alone" }, form));
  name.focus();
}
