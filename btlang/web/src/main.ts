// Start: who is logged in sees the shell, everybody else the log-in.
import { address } from "./address";
import { enter as enterByToken, whoAmI } from "./api";
import { fill, h } from "./dom";
import { Shell } from "./shell";
import { language, loadTexts, t } from "./texts";
import { applyTheme } from "./theme";

async function start(): Promise<void> {
  await loadTexts();
  document.documentElement.lang = language();
  applyTheme();
  const token = /^#token=([\w-]+)$/.exec(location.hash)?.[1];
  if (token) return openScreen(token);
  if (location.pathname === "/login") return showLogin();
  let me;
  try {
    me = await whoAmI();
  } catch {
    fill(document.body, h("main", { class: "alone" }, h("p", { role: "alert" }, t("offline"))));
    setTimeout(start, 1000);
    return;
  }
  if (me) new Shell(me, start);
  else await showLogin();
}

/** The only screen of `btc edit` or `btc watch`. */
async function openScreen(token: string): Promise<void> {
  try {
    const { screen } = await enterByToken(token);
    history.replaceState(null, "", `/${address(...screen)}`);
    await start();
  } catch (error) {
    fill(document.body, h("main", { class: "alone" }, h("p", { role: "alert" }, (error as Error).message)));
  }
}

/** The log-in comes when it's needed: whoever watches a robot is logged in. */
async function showLogin(): Promise<void> {
  (await import("./login")).showLogin(enter);
}

function enter(): void {
  history.replaceState(null, "", `/${location.hash}`);
  void start();
}

void start();
