// Users, tokens and the trail, for administrators alone; and the command palette, by keys alone. Pictures go into a folder.
import assert from "node:assert/strict";
import { accessible, fits, logIn, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);
const REFUSED = /status of (400|401|403|409)|WebSocket/;

await visit(base, async (page, context) => {
  const until = (text, where = "main") => page.waitForFunction(([text, where]) => [...document.querySelectorAll(where)].some((each) => each.textContent.includes(text)), [text, where]);
  const look = async (name) => {
    for (const theme of ["dark", "light"]) {
      for (const size of [{ width: 360, height: 740 }, { width: 1440, height: 900 }]) {
        await page.evaluate((theme) => (document.documentElement.dataset.theme = theme), theme);
        await page.setViewportSize(size);
        await page.waitForTimeout(300);
        await fits(page);
        await page.screenshot({ path: `${pictures}/${name}_${theme}_${size.width}.png` });
        await accessible(page, `${name}, ${theme}, ${size.width}`);
      }
    }
  };
  const card = (name) => page.locator(".users > li", { has: page.locator("strong", { hasText: name }) });
  const secret = async () => {
    const text = await page.textContent(".secret code");
    await page.getByRole("button", { name: "Close" }).click();
    return text;
  };
  const loaded = [];
  page.on("request", (request) => loaded.push(request.url()));

  // Others have no way to it, and its files and texts don't come to them.
  await logIn(page, base, "ed", password);
  await page.click(".user");
  assert.ok(!(await page.textContent("[role=menu]")).includes("Users"));
  await page.keyboard.press("Escape");
  await page.goto(`${base}/#/accounts`);
  await page.waitForSelector(".watch, .robots");
  assert.equal(await page.$(".accounts"), null);
  assert.ok(!loaded.some((url) => /accounts|\/api\/(users|trail)/.test(url)), String(loaded));
  assert.deepEqual(await page.evaluate(async () => Promise.all(["users", "trail"].map(async (each) => (await fetch(`/api/${each}`)).status))), [403, 403]);
  await page.click(".user");
  await page.getByRole("menuitem", { name: "Log out" }).click();
  await page.waitForSelector(".login");

  // An administrator adds somebody, who comes in with the password that is shown once.
  await logIn(page, base, "ann", password);
  assert.ok(!loaded.some((url) => /accounts|palette/.test(url)), "the screen came before somebody opened it");
  await page.click(".user");
  await page.getByRole("menuitem", { name: "Users" }).click();
  await page.waitForSelector(".users > li:nth-child(5)");
  await until("/api/trail", ".trail li"); // which ed had asked for
  assert.equal(await page.title(), "robot · Users · btlang");
  assert.equal(await card("ann").getByRole("button", { name: "Remove" }).count(), 0, "administrators remove themselves");
  await page.getByRole("button", { name: "Add a user …" }).click();
  await page.fill("dialog [name=name]", "kim");
  await page.selectOption("dialog [name=role]", "viewer");
  await page.click("dialog .primary");
  const first = await secret();
  assert.match(first, /^\w{5}(-\w{5}){3}$/);
  await page.waitForFunction(() => document.activeElement.textContent === "Add a user …");
  await page.getByRole("button", { name: "Add a user …" }).click();
  await page.fill("dialog [name=name]", "kim");
  await page.click("dialog .primary");
  await until("The user 'kim' exists already.", "dialog .problem");
  await look("users_refused");
  await page.keyboard.press("Escape");
  const other = await context.browser().newContext({ ignoreHTTPSErrors: true, locale: "en-GB" });
  const kim = await other.newPage();
  await logIn(kim, base, "kim", first);
  await kim.click(".robots a");
  await kim.waitForSelector(".watch");

  // The role changes at once; a token is made, shown once, and revoked; whoever is removed is out at once.
  await card("kim").getByRole("combobox").selectOption("operator");
  await until("give 'kim' the role operator", ".trail li");
  assert.equal(await kim.evaluate(async () => (await (await fetch("/api/me")).json()).role), "operator");
  await card("kim").locator("summary").click();
  await card("kim").getByRole("button", { name: "New token" }).click();
  await page.fill("dialog [name=token]", "phone");
  await page.click("dialog .primary");
  await page.waitForSelector(".secret");
  await look("users_token");
  const token = await secret();
  assert.match(token, /^btl_/);
  await until("Tokens (1)", "summary");
  const asked = () => page.evaluate(async (token) => (await fetch("/api/robots", { headers: { authorization: `Bearer ${token}` } })).status, token);
  assert.equal(await asked(), 200);
  await look("users");
  await card("kim").getByRole("button", { name: "Revoke" }).click();
  await page.click("dialog .primary");
  await until("Tokens (0)", ".users > li summary");
  assert.equal(await asked(), 401);
  await page.waitForFunction(() => document.activeElement.textContent === "New token …");
  await card("kim").getByRole("button", { name: "New password" }).click();
  await page.click("dialog .primary");
  const second = await secret();
  await kim.waitForSelector(".login");
  await kim.fill("[name=name]", "kim");
  await kim.fill("[name=password]", second);
  await kim.click("form button");
  await kim.waitForSelector(".tabs");
  await card("kim").getByRole("button", { name: "Log out" }).click();
  await kim.waitForSelector(".login");
  await card("kim").getByRole("button", { name: "Remove" }).click();
  await page.click("dialog .primary");
  await page.waitForFunction(() => document.querySelectorAll(".users > li").length === 5);
  await kim.fill("[name=name]", "kim");
  await kim.fill("[name=password]", second);
  await kim.click("form button");
  await kim.waitForFunction(() => document.querySelector(".problem").textContent.includes("wrong"));
  await other.close();

  // The trail, filtered.
  await page.fill(".filter [type=search]", "kim");
  await page.waitForFunction(() => [...document.querySelectorAll(".trail li")].every((each) => each.textContent.includes("kim")));
  assert.ok((await page.$$(".trail li")).length >= 8);
  await page.check(".filter [type=checkbox]");
  await page.waitForFunction(() => [...document.querySelectorAll(".trail .pill")].every((each) => /refused|wrong/.test(each.textContent)));
  await look("users_trail");

  // The password is wanted again after some minutes: the server then answers so.
  let late = true;
  await page.route("**/api/users", (route) => {
    if (route.request().method() === "GET" || !late) return route.continue();
    return route.fulfill({ status: 403, json: { ok: false, text: "Confirm your password first.", code: "confirm" } });
  });
  page.on("response", (response) => response.url().endsWith("/api/confirm") && response.ok() && (late = false));
  await card("vic").getByRole("combobox").selectOption("operator");
  await page.fill("dialog [name=password]", "a wrong one");
  await page.click("dialog .primary");
  await until("The name or the password is wrong.", "dialog .problem");
  await page.fill("dialog [name=password]", password);
  await page.click("dialog .primary");
  await page.waitForSelector("dialog", { state: "detached" });
  await page.fill(".filter [type=search]", "");
  await page.uncheck(".filter [type=checkbox]");
  await until("give 'vic' the role operator", ".trail li");
  late = true;
  await card("vic").getByRole("combobox").selectOption("viewer");
  await page.waitForSelector("dialog [name=password]");
  await page.keyboard.press("Escape");
  await until("Confirm your password first.", ".accounts > .problem");
  assert.equal(await card("vic").getByRole("combobox").inputValue(), "operator", "a role is shown that isn't");
  late = false;
  await card("vic").getByRole("combobox").selectOption("viewer");
  await until("give 'vic' the role viewer", ".trail li");

  // Who is no administrator any more sees nothing of it.
  await page.unroute("**/api/users");
  await page.route("**/api/users", (route) => route.request().method() === "GET" ? route.fulfill({ status: 403, json: { ok: false, text: "Only administrators may do this.", code: "" } }) : route.continue());
  await card("vic").getByRole("button", { name: "Log out" }).click();
  await until("Only administrators may do this.", ".accounts > .problem");
  assert.equal(await page.$$eval(".users, .trail", (all) => all.length), 0);
  await page.unroute("**/api/users");

  // In Spanish.
  await page.evaluate(() => localStorage.setItem("btlang.language", "es"));
  await page.reload();
  await until("Qué se ha hecho");
  await until("eliminar el usuario «kim»", ".trail li");
  const english = /\b(Users|Viewer|since|New|Log out|Remove|Tokens? \(|entries|done|refused)\b/;
  assert.doesNotMatch((await page.innerText("main")).replace(/Tokens \(/g, ""), english);
  await look("users_es");
}, {}, REFUSED);
