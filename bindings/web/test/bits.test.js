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
// Angles and powers come from functions whose last bit the standard library does not fix: see docs/WEB.md.
const BY_FUNCTIONS = /^(shape_index|shape_index_error|curvedness|curvedness_error)$/;

/** @type {Awaited<ReturnType<typeof open>>} */ let ask;
/** @type {any} */ let about;
let folder = "";

before(async () => {
  ask = await open(await readFile(new URL("../dist/helfrich.wasm", import.meta.url)), () => {});
  about = ask({ do: "about" }).text;
  folder = await mkdtemp(join(tmpdir(), "helfrich-web-"));
});
after(() => rm(folder, { recursive: true }));

/** Columns in which two tables differ, with the largest relative difference. */
function differences(one, two) {
  const [a, b] = [one, two].map((text) => text.trimEnd().split("\n").map((line) => line.split(",")));
  assert.deepEqual(a[0], b[0]);
  assert.equal(a.length, b.length);
  /** @type {Record<string, number>} */ const found = {};
  for (let row = 1; row < a.length; row++) {
    a[row].forEach((text, column) => {
      if (text === b[row][column]) return;
      const [x, y] = [Number(text), Number(b[row][column])];
      const apart = Math.abs(x - y) / Math.max(Math.abs(x), Math.abs(y));
      found[a[0][column]] = Math.max(found[a[0][column]] ?? 0, Number.isNaN(apart) ? Infinity : apart);
    });
  }
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
      if (process.env.SHOW) console.log(example, method, all);
      for (const [column, apart] of all) {
        assert.match(column, BY_FUNCTIONS, `${example}, ${method}: ${column} differs by ${apart}`);
        assert.ok(apart < 1e-13, `${example}, ${method}: ${column} differs by ${apart}`);
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
