// Pictures of a page against those that somebody has looked at. UPDATE_GOLDEN=1 writes them.
import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import pixelmatch from "pixelmatch";
import { PNG } from "pngjs";

const SIZE = { width: 800, height: 600 };
const MOST = 0.0002; // of all pixels: letters are smoothed in other ways, but a button that moved has more
/** Times, numbers and what the robot has come to just then. */
const STYLE = `
  time, .number, .why, .clock, .map, .values, .watch .doing, .log, .now .pill, .film-page h1, input[type=date] { visibility: hidden !important; }
  ol.tasks li:not(:last-child) { display: none !important; }
  *, ::before, ::after { transition: none !important; animation: none !important; scrollbar-width: none !important; caret-color: transparent !important; }
  .cm-cursorLayer, .cm-tooltip { display: none !important; }`;

/** With 16 shades of each colour, which makes a file half as long. */
function coarse(picture) {
  for (let at = 0; at < picture.data.length; at++) if (at % 4 < 3) picture.data[at] = (picture.data[at] & 0xf0) | (picture.data[at] >> 4);
  return picture;
}

const written = (picture) => PNG.sync.write(picture, { colorType: 2, deflateLevel: 9, deflateStrategy: 0, filterType: 0 });

/** A picture of the page once it no longer changes: colours of words come later on a busy computer. */
async function settled(page) {
  const take = () => page.screenshot({ animations: "allow", caret: "initial" });
  await page.waitForTimeout(300);
  let before = await take();
  for (let round = 0; round < 5; round++) {
    await page.waitForTimeout(500);
    const now = await take();
    if (now.equals(before)) break;
    before = now;
  }
  return before;
}

/** A function that looks at a page under a name, for people in `found`, and compares it where fonts are those of the golden
 *  pictures in `folder`; without a folder nothing is done.
 */
export async function gallery(page, folder, found) {
  if (!folder) return async () => undefined;
  const update = process.env.UPDATE_GOLDEN === "1";
  const fonts = await page.evaluate(() => {
    const pen = document.createElement("canvas").getContext("2d");
    return ["system-ui", "monospace"].map((name) => ((pen.font = `20px ${name}`), pen.measureText("Behavior trees 0123").width));
  });
  if (update) writeFileSync(`${folder}/fonts.json`, `${JSON.stringify(fonts)}\n`);
  const same = readFileSync(`${folder}/fonts.json`, "utf8") === `${JSON.stringify(fonts)}\n`;
  if (!same) console.log("Other fonts: pictures aren't compared.");
  const look = async (name) => {
    const before = page.viewportSize();
    await page.setViewportSize(SIZE);
    await page.mouse.move(0, 0);
    await page.evaluate((text) => { // an element would need the nonce of the policy
      const style = new CSSStyleSheet();
      style.replaceSync(text);
      document.adoptedStyleSheets = [...document.adoptedStyleSheets, style];
    }, STYLE);
    const now = coarse(PNG.sync.read(await settled(page)));
    await page.evaluate(() => (document.adoptedStyleSheets = document.adoptedStyleSheets.slice(0, -1)));
    await page.setViewportSize(before);
    const file = `${folder}/${name}.png`;
    if (update) writeFileSync(file, written(now));
    writeFileSync(`${found}/${name}.png`, written(now));
    if (!same) return;
    assert.ok(existsSync(file), `there's no golden picture ${name}`);
    const golden = PNG.sync.read(readFileSync(file));
    const difference = new PNG(SIZE);
    const count = pixelmatch(golden.data, now.data, difference.data, SIZE.width, SIZE.height);
    if (count > MOST * SIZE.width * SIZE.height) writeFileSync(`${found}/${name}_difference.png`, written(difference));
    assert.ok(count <= MOST * SIZE.width * SIZE.height, `${name} differs in ${count} pixels: see ${found}`);
  };
  return Object.assign(look, { compares: same });
}
