// Components and devices of a robot: states, why one is silent, a restart, and what a camera sees.
import assert from "node:assert/strict";
import { accessible, fits, logIn, visit } from "./browser.mjs";

const [base, password, pictures] = process.argv.slice(2);

await visit(base, async (page) => {
  await logIn(page, base, "ann", password);
  await page.click(".robots a");
  await page.click(".parts > summary");
  const line = (name) => page.locator(".parts li", { hasText: name }).first();
  await line("machine").locator(".pill", { hasText: "active" }).waitFor();
  await line("sonar").locator(".why", { hasText: "switched off" }).waitFor();
  await line("eye").locator("summary").click();
  await page.waitForFunction(() => document.querySelector(".parts img")?.naturalWidth === 160);
  const first = await page.getAttribute(".parts img", "src");
  await page.waitForFunction((before) => document.querySelector(".parts img").src !== before || document.querySelector(".parts img").naturalWidth, first);
  await accessible(page, "parts");
  await page.screenshot({ path: `${pictures}/parts.png`, fullPage: true });
  await line("machine").locator("button").click();
  await line("machine").locator("small", { hasText: "started 2 times" }).waitFor();
  await page.setViewportSize({ width: 360, height: 740 });
  await fits(page);
  assert.equal(await page.locator(".parts .problem").textContent(), "");

  await page.click(".user");
  await page.getByRole("menuitem", { name: "Español" }).click();
  await page.click(".parts > summary");
  await line("machine").locator(".pill", { hasText: "activo" }).waitFor();
});
