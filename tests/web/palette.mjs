// The command palette, by keys alone. Pictures go into a folder.
import assert from "node:assert/strict";
import { accessible, fits, logIn, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);

await visit(base, async (page) => {
  const open = async () => {
    await page.keyboard.press("Control+K");
    await page.waitForSelector("dialog [role=combobox]:focus");
  };
  const chosen = () => page.evaluate(() => document.getElementById(document.activeElement.getAttribute("aria-activedescendant"))?.textContent);
  const run = async (words) => {
    await open();
    await page.keyboard.type(words);
    await page.keyboard.press("Enter");
    await page.waitForSelector("dialog", { state: "detached" });
  };
  const at = (hash) => page.waitForFunction((hash) => location.hash === hash, hash);
  const loaded = [];
  page.on("request", (request) => loaded.push(request.url()));

  await logIn(page, base, "ed", password);
  const saved = await page.evaluate(async () => {
    const { csrf } = await (await fetch("/api/me")).json();
    return (await fetch("/api/missions/night_round", { method: "PUT", headers: { "content-type": "application/json", "x-csrf-token": csrf }, body: JSON.stringify({ text: "wave", revision: 0 }) })).ok;
  });
  assert.ok(saved);
  assert.ok(!loaded.some((url) => /palette|more\./.test(url)), "the palette came before somebody opened it");

  // It opens and closes, says what is chosen, and gives the focus back.
  await page.focus(".user");
  await open();
  await page.waitForFunction(() => [...document.querySelectorAll("[role=option]")].some((each) => each.textContent.includes("night round")));
  const names = await page.$$eval("[role=option]", (all) => all.map((each) => each.textContent));
  assert.match(names.at(-1), /^Emergency stop/, "Enter in an empty palette stops a robot");
  assert.ok(!names.some((each) => each.startsWith("Users")), "somebody else than an administrator is led to the users");
  assert.equal(await page.getAttribute("dialog", "aria-label"), "Commands");
  assert.equal(await page.getAttribute("[role=option]", "aria-selected"), "true");
  await page.keyboard.press("ArrowUp");
  assert.match(await chosen(), /^Emergency stop/);
  await page.keyboard.press("ArrowDown");
  assert.equal(await chosen(), names[0]);
  for (const theme of ["dark", "light"]) {
    for (const size of [{ width: 360, height: 740 }, { width: 1440, height: 900 }]) {
      await page.evaluate((theme) => (document.documentElement.dataset.theme = theme), theme);
      await page.setViewportSize(size);
      await page.waitForTimeout(200);
      await fits(page);
      await page.screenshot({ path: `${pictures}/palette_${theme}_${size.width}.png` });
      await accessible(page, `palette, ${theme}, ${size.width}`);
    }
  }
  await page.keyboard.type("no such thing");
  await page.waitForFunction(() => document.querySelector(".commands-none").textContent === "There's no such command.");
  await page.keyboard.press("Enter");
  await page.keyboard.press("Control+K");
  await page.waitForSelector("dialog", { state: "detached" });
  assert.equal(await page.evaluate(() => document.activeElement.className), "user");

  // Robots, screens, missions.
  await run("robot");
  await page.waitForSelector(".robots, .watch");
  await open();
  await page.keyboard.type("robot");
  while (!/^robotRobots$/.test(await chosen())) await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await at("#/robots/robot");
  await page.waitForSelector(".watch");
  await run("task");
  await at("#/robots/robot/tasks");
  await open();
  await page.waitForFunction(() => [...document.querySelectorAll("[role=option]")].some((each) => each.textContent.includes("night round")));
  await page.keyboard.type("round");
  await page.keyboard.press("Enter");
  await at("#/write/night_round");

  // Also while somebody writes.
  await page.waitForSelector('.panes .text .cm-content[contenteditable="true"]');
  await page.click(".panes .text .cm-content");
  await run("look back");
  await at("#/runs");

  // Theme, language, and the stop.
  await run("dark");
  await page.waitForFunction(() => document.documentElement.dataset.theme === "dark");
  await run("espanol"); // without the accents
  await page.waitForSelector(".tabs a:has-text('Tareas')");
  await open();
  const spanish = await page.$$eval("[role=option]", (all) => all.map((each) => each.textContent));
  assert.ok(spanish.includes("Idioma: EnglishLa página"), String(spanish));
  await page.keyboard.type("parada");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".latch");
  await page.click(".release");
  await page.waitForSelector(".latch", { state: "detached" });
  await run("english");
  await page.waitForSelector(".tabs a:has-text('Tasks')");
  await run("log out");
  await page.waitForSelector(".login");
});
