// Bundles the page into dist/: files with a hash in their names, and index.html, which loads the first of them.
import { readFile, rm, writeFile } from "node:fs/promises";
import { basename } from "node:path";
import { build } from "esbuild";

await rm("dist", { recursive: true, force: true });
const { metafile } = await build({
  entryPoints: ["src/main.ts", "src/style/main.css"],
  entryNames: "[name]-[hash]",
  chunkNames: "[name]-[hash]",
  assetNames: "[name]-[hash]",
  outdir: "dist/files",
  bundle: true,
  splitting: true,
  format: "esm",
  target: "es2022",
  minify: true,
  legalComments: "none",
  charset: "utf8",
  metafile: true,
});
const outputs = Object.entries(metafile.outputs);
const fileOf = (entry) => basename(outputs.find(([, output]) => output.entryPoint === entry)[0]);
const index = (await readFile("src/index.html", "utf8"))
  .replace("SCRIPT", fileOf("src/main.ts"))
  .replace("STYLE", fileOf("src/style/main.css"));
await writeFile("dist/index.html", index);

// What somebody needs who watches a robot: main, the screen of that, and what both import without waiting for anybody.
const first = new Set();
const FIRST = ["src/main.ts", "src/style/main.css", "src/watch/watch.ts"];
const waiting = outputs.filter(([, output]) => FIRST.includes(output.entryPoint)).map(([path]) => path);
while (waiting.length) {
  const path = waiting.pop();
  if (first.has(path)) continue;
  first.add(path);
  waiting.push(...metafile.outputs[path].imports.filter((each) => each.kind === "import-statement").map((each) => each.path));
}
await writeFile("dist/first_load.json", JSON.stringify([...first].map((path) => basename(path))));
