// Text, tree, map, log and values are one view, live and in the replay: who selects in one sees it in all. Also in Spanish.
import assert from "node:assert/strict";
import { accessible, fits, logIn, submit, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);
const MISSION = "set cups to 3\nwave\nrepeat 2 times: decrease cups by 1\ngo to the cafe\nwait 10 minutes";

await visit(base, async (page) => {
  await page.setViewportSize({ width: 1440, height: 900 });
  await logIn(page, base, "olga", password);
  const until = (text, where) => page.waitForFunction(([text, where]) => [...document.querySelectorAll(where)].some((each) => each.textContent.includes(text)), [text, where]);
  const selected = () => page.$eval(".node[aria-selected=true]", (node) => node.textContent.trim());
  const onScreen = (where) => page.$eval(where, (each) => each.getBoundingClientRect().bottom <= innerHeight && each.getBoundingClientRect().top >= 0);
  const colour = (where) => page.$eval(`.film-text ${where}`, (mark) => getComputedStyle(mark).backgroundColor);
  const clickOn = async (words) => { // in the text
    const at = await page.$eval(".film-text", (text, words) => {
      const range = document.createRange();
      const walker = document.createTreeWalker(text, NodeFilter.SHOW_TEXT);
      for (let part = walker.nextNode(); part; part = walker.nextNode()) {
        const found = part.data.indexOf(words);
        if (found < 0) continue;
        range.setStart(part, found + 1);
        range.setEnd(part, found + 2);
        const { left, top, height } = range.getBoundingClientRect();
        return [left + 1, top + height / 2];
      }
      return null;
    }, words);
    await page.mouse.click(...at);
  };
  const selects = async () => {
    await page.locator(".node", { hasText: /go to cafe/ }).first().click();
    await page.waitForSelector(".map[aria-label='Map: cafe']");
    await page.locator(".node", { hasText: /^\s*wave/ }).first().click();
    await page.waitForSelector(".map[aria-label='Map']");
    const { width, height } = await page.locator(".map").boundingBox();
    for (let x = 10; x < width && !/cafe/.test(await selected()); x += 30) {
      for (let y = 10; y < height && !/cafe/.test(await selected()); y += 30) await page.locator(".map").click({ position: { x, y } });
    }
    assert.match(await selected(), /go to cafe/, "the map selects nothing");
    await page.waitForSelector(".map[aria-label='Map: cafe']");
    await page.locator(".node", { hasText: /^\s*wave/ }).first().click();
    await until("wave", ".film-text mark.chosen");
    await clickOn("repeat 2 times");
    assert.match(await selected(), /repeat 2 times/);
    await page.locator(".log button", { hasText: "wave" }).first().click();
    await page.waitForFunction(() => document.querySelector(".node[aria-selected=true]").textContent.includes("wave"));
  };

  await page.click(".robots a");
  await page.waitForSelector(".watch");
  const cancel = page.getByRole("button", { name: "Cancel" });
  if (await cancel.waitFor({ timeout: 2000 }).then(() => true, () => false)) await cancel.click(); // what another test has left
  await cancel.waitFor({ state: "detached" });
  for (const where of [".log", "summary", ".map"]) assert.ok(await onScreen(where), `${where} is below the fold`);
  await submit(page, MISSION);
  await until("wait 600 s", ".running");
  await until("wait 10 minutes", ".film-text mark.runs");
  await page.waitForSelector(".node[data-status=RUNNING]");
  assert.equal(await page.$(".scroll.chosen"), null, "a node is selected that nobody chose");
  for (const name of ["battery, %", "cups"]) await until(name, ".watch .plots li");
  await page.waitForFunction(() => [...document.querySelectorAll(".watch .plots li")].some((each) => each.textContent === "cups1"));
  for (const where of [".log", ".film-text", ".watch .tree", ".map", ".watch .plots"]) assert.ok(await onScreen(where), `${where} is below the fold`);
  await selects();
  await page.waitForSelector(".film-text mark.chosen:not(.runs):text-is('wave')");
  assert.notEqual(await colour("mark.chosen"), await colour("mark.runs"), "what is selected looks as if it ran");
  await accessible(page, "one view");
  await page.screenshot({ path: `${pictures}/view_live.png` });

  await page.click("header .robot"); // what works isn't ready
  await until("At work", ".robots .pill");
  await until("set cups to 3", ".robots .mission");
  await page.waitForSelector(".robots .place:not(.stale) .map");
  assert.match(await page.getAttribute(".robots meter", "aria-label"), /battery \d+%/);
  await accessible(page, "robots");
  await page.screenshot({ path: `${pictures}/robots.png` });
  await page.click(".robots a");
  await until("wait 600 s", ".running");
  await cancel.click();
  await page.click(".tabs a[href$='/runs']");
  await page.locator("li", { hasText: "set cups" }).getByRole("link", { name: "Replay" }).click();
  await page.waitForSelector(".film .plots li");
  assert.ok((await page.$eval(".outcome", (each) => each.className)).includes("quiet"));
  for (const where of [".story", ".film-text", ".film .tree", ".map", ".timeline"]) assert.ok(await onScreen(where), `${where} is below the fold`);
  await selects();
  assert.match(await page.textContent(".story"), /wait 600 s: was halted/); // at the time when it began
  const plots = await page.$$eval(".plots li", (all) => all.map((each) => each.firstElementChild.textContent));
  for (const wanted of ["battery, %", "cups"]) assert.ok(plots.includes(wanted), String(plots));
  const picture = page.locator(".plots li", { hasText: "cups" }).locator("svg");
  const { x: left, width } = await picture.boundingBox();
  const track = await page.locator(".timeline input").boundingBox();
  assert.ok(Math.abs(track.x + 8 - left) < 2 && Math.abs(track.width - 16 - width) < 2, "the values have another time line than the slider");
  await picture.click({ position: { x: width - 2, y: 5 } });
  await page.waitForFunction(() => [...document.querySelectorAll(".plots li")].some((each) => each.textContent === "cups1"));
  const [now, all] = (await page.textContent(".clock")).split(" / ");
  assert.ok(now !== "0:00.0" && now <= all, now);
  await accessible(page, "one view, replay");
  await page.screenshot({ path: `${pictures}/view_replay.png` });
  for (const size of [{ width: 360, height: 740 }, { width: 1000, height: 700 }]) {
    await page.setViewportSize(size);
    await fits(page);
    await page.screenshot({ path: `${pictures}/view_replay_${size.width}.png` });
  }

  await page.setViewportSize({ width: 1440, height: 900 });
  await page.click(".user");
  await page.getByRole("menuitem", { name: "Español" }).click();
  await until("Repasar", ".tabs");
  assert.equal(await page.evaluate(() => document.documentElement.lang), "es");
  await page.click(".tabs a[href*='/robots/']:not([href$='/tasks'])");
  await until("Lo que ha pasado", ".events h2");
  for (const words of ["saluda", "repite 2 veces", "ve a cafe", "espera 600 s"]) await until(words, ".node .words"); // not the mission, which is in English
  await until("wait 10 minutes", ".film-text");
  await page.screenshot({ path: `${pictures}/view_spanish.png` });
  await page.click(".tabs a[href$='/runs']");
  await page.locator("li", { hasText: "set cups" }).getByRole("link", { name: "Reproducir" }).click();
  await until("espera 600 s: se interrumpió", ".story");
  await until("espera 600 s", ".film .node .words");
  await page.click(".tabs a[href*='/robots/']:not([href$='/tasks'])");
  await page.reload();
  await until("Darle trabajo", "summary");
  await until("Aquí aparece lo que pase a partir de ahora.", ".log"); // an empty log would say that nothing happened
  await page.click(".tabs a[href$='/tasks']");
  await page.fill(".submit textarea", "go to the caffe");
  await page.click(".submit .primary");
  await until("Línea 1: No hay nada llamado «caffe»", ".submit .problem");
  await page.fill(".submit textarea", "wave");
  await page.fill(".submit input", "on Mondays and Fridays at 9:00");
  await page.click(".submit .primary");
  await until("Programado: cada lunes y viernes a las 09:00", ".submit .said");
  await until("cada lunes y viernes a las 09:00", "ul.tasks .pill");
  await page.screenshot({ path: `${pictures}/view_spanish_tasks.png` });
  await page.click("button[aria-label^='Quitar']");
});
