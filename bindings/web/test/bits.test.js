// The numbers of the page are those of the program, bit for bit: tables of both are compared as texts, whose digits
// identify every number. HELFRICH names the program.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { open } from "../page/instance.js";

const PROGRAM = process.env.HELFRICH ?? "helfrich";
const VERTICES = 642;
// Functions such as exp and hypot differ in their last bits between standard libraries: see docs/WEB.md. Without noise
// only these columns and methods need one; with noise, or triangles that are too bad for a fit, all depend on some.
const BY_FUNCTIONS = /^(curvedness|shape_index)/;
const METHODS_BY_FUNCTIONS = ["belkin", "loop", "j8"];
const BY_ARITHMETIC = ["discocyte", "torus", "ellipsoid"];
/** The largest difference elsewhere, relative to the largest value of the column. */
const LAST_BITS = 1e-9;

/** @type {Awaited<ReturnType<typeof open>>} */ let ask;
/** @type {any} */ let about;
let folder = "";

before(async () => {
  ask = await open(await readFile(new URL("../dist/helfrich.wasm", import.meta.url)), () => {});
  about = ask({ do: "about" }).text;
  folder = await mkdtemp(join(tmpdir(), "helfrich-web-"));
});
after(() => rm(folder, { recursive: true }));

/** Columns in which two tables differ, with the largest difference relative to the largest value. */
function differences(one, two) {
  const [a, b] = [one, two].map((text) => text.trimEnd().split("\n").map((line) => line.split(",")));
  assert.deepEqual(a[0], b[0]);
  assert.equal(a.length, b.length);
  /** @type {Record<string, number>} */ const found = {};
  a[0].forEach((name, column) => {
    const pairs = a.slice(1).map((row, at) => [row[column], b[at + 1][column]]);
    const differing = pairs.filter(([x, y]) => x !== y);
    if (!differing.length) return;
    const largest = Math.max(...pairs.map(([x]) => Math.abs(Number(x))).filter(Number.isFinite));
    const apart = differing.map(([x, y]) => Math.abs(Number(x) - Number(y)) / largest);
    found[name] = apart.some(Number.isNaN) ? Infinity : Math.max(...apart);
  });
  return found;
}

test("every method on every example has the numbers of the program", async () => {
  for (const example of about.examples) {
    const name = join(folder, "mesh.ply");
    ask({ do: "example", name: example, vertices: VERTICES });
    ask({ do: "evaluate", slot: 0, method: "gompper-kroll", errors: false });
    await writeFile(name, ask({ do: "save", name: "mesh.ply", slot: 0, quantity: "H" }).arrays.file);
    for (const { name: method } of about.methods) {
      ask({ do: "evaluate", slot: 0, method, errors: true });
      const own = new TextDecoder().decode(ask({ do: "save", name: "mesh.csv", slot: 0, quantity: "H" }).arrays.file);
      const program = execFileSync(PROGRAM, ["curvature", name, "--method", method, "--errors"], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"], maxBuffer: 2 ** 28 });
      const all = Object.entries(differences(own, program));
      const isExact = BY_ARITHMETIC.includes(example) && !METHODS_BY_FUNCTIONS.includes(method);
      for (const [column, apart] of all) {
        const limit = isExact && !BY_FUNCTIONS.test(column) ? 0 : LAST_BITS;
        assert.ok(apart <= limit, `${example}, ${method}: ${column} differs by ${apart}, and ${limit} is allowed`);
      }
    }
  }
});

test("a file that is no mesh is refused in the words of the program", async () => {
  const files = {
    "bow-tie.off": "OFF\n5 2 0\n0 0 0\n1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n3 0 1 2\n3 0 3 4\n",
    "short.obj": "v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n",
    "empty.ply": "",
    "mesh.step": "ISO-10303-21;\n",
  };
  for (const [name, text] of Object.entries(files)) {
    const path = join(folder, name);
    await writeFile(path, text);
    let program = "";
    try {
      execFileSync(PROGRAM, ["info", path], { encoding: "utf8", stdio: "pipe" });
    } catch (error) {
      program = error.stderr.trim();
    }
    assert.throws(
      () => ask({ do: "read", name }, new TextEncoder().encode(text)),
      (error) => {
        assert.equal(`error: ${error.message}`, program.replaceAll(path, name));
        return true;
      },
    );
  }
});
