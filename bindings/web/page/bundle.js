// Writes dist/index.html: the page with its scripts, its style and the module of WebAssembly, which is named first.
import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { deflateRawSync } from "node:zlib";

const here = new URL(".", import.meta.url);
const script = async (/** @type {string} */ name) => {
  const made = await build({
    entryPoints: [new URL(name, here).pathname],
    bundle: true, minify: true, write: false, format: "iife", target: "es2022", legalComments: "none",
  });
  // The end of a script must not stand within it.
  return made.outputFiles[0].text.trim().replaceAll("</script", "<\\/script");
};
const wasm = await readFile(process.argv[2]);
const packed = deflateRawSync(wasm, { level: 9 });
const parts = {
  STYLE: await readFile(new URL("style.css", here), "utf8"),
  WASM: packed.toString("base64"),
  WORKER: await script("worker.js"),
  MAIN: await script("main.js"),
};
let page = await readFile(new URL("index.html", here), "utf8");
for (const [name, text] of Object.entries(parts)) page = page.replace(`/*${name}*/`, () => text);
const folder = new URL("../dist/", here);
await mkdir(folder, { recursive: true });
await writeFile(new URL("index.html", folder), page);
// For tests in Node.js; the page does not need it.
await writeFile(new URL("helfrich.wasm", folder), wasm);
const bytes = Buffer.byteLength(page);
console.log(`index.html: ${bytes} bytes; WebAssembly: ${wasm.length}, deflated ${packed.length}`);
// The aim of docs/WEB.md, which is not reached yet.
if (bytes > 500_000) console.warn(`dist/index.html has ${bytes} bytes: at most 500000 are wanted`);
