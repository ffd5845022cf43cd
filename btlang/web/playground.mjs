// Makes the playground: its page and worker, Python for browsers (Pyodide), and btlang packed for that Python.
// node playground.mjs SOURCES OUT: SOURCES is an archive of modules and data files as they stand on Python's path.
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { loadPyodide } from "pyodide";

const [sources, out] = process.argv.slice(2);
const PYODIDE = dirname(fileURLToPath(import.meta.resolve("pyodide")));
const PYTHON = ["pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip"];
const [PATH, HOME, ARCHIVE] = ["/lib/btlang", "/home/pyodide", "/tmp/btlang.zip"]; // as in src/playground/worker.ts

await mkdir(out, { recursive: true });
const options = { bundle: true, format: "esm", target: "es2022", minify: true, legalComments: "none", charset: "utf8", outdir: out, external: ["node:*"] };
const { metafile } = await build({ ...options, entryPoints: ["src/playground/page.ts", "src/playground/page.css"], entryNames: "[name]-[hash]", metafile: true });
await build({ ...options, entryPoints: ["src/playground/worker.ts"] });
const fileOf = (entry) => basename(Object.entries(metafile.outputs).find(([, output]) => output.entryPoint === entry)[0]);
const page = (await readFile("src/playground/index.html", "utf8")).replace("SCRIPT", fileOf("src/playground/page.ts")).replace("STYLE", fileOf("src/playground/page.css"));
await writeFile(join(out, "index.html"), page);

for (const name of PYTHON) await copyFile(join(PYODIDE, name), join(out, name));
const { info } = JSON.parse(await readFile(join(PYODIDE, "pyodide-lock.json"), "utf8"));
await writeFile(join(out, "lock.json"), JSON.stringify({ info, packages: {} })); // nothing is fetched from elsewhere

const python = await loadPyodide({ env: { HOME } });
python.unpackArchive(new Uint8Array(await readFile(sources)), "zip", { extractDir: PATH });
python.runPython(`
import sys
sys.path.append("${PATH}")
from btlang.playground import prepare
prepare("${HOME}")
from btlang.playground.packing import pack
pack("${PATH}", "${HOME}", "${ARCHIVE}")
`);
await writeFile(join(out, "btlang.zip"), python.FS.readFile(ARCHIVE));
