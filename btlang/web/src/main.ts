// Start: who is logged in sees the shell, everybody else the log-in.
import { whoAmI } from "./api";
import { fill, h } from "./dom";
import { showLogin } from "./login";
import { Shell } from "./shell";
import { language, t } from "./texts";
import { applyTheme } from "./theme";

async function start(): Promise<void> {
  document.documentElement.lang = language();
  applyTheme();
  if (location.pathname === "/login") return showLogin(enter);
  let me;
  try {
    me = await whoAmI();
  } catch {
    fill(document.body, h("main", { class: "alone" }, h("p", { role: "alert" }, t("offline"))));
    setTimeout(start, 1000);
    return;
  }
  if (me) new Shell(me, start);
  else showLogin(enter);
}

function enter(): void {
  history.replaceState(null, "", `/${location.hash}`);
  void start();
}

void start();
