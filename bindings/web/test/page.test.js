// Every control of the page in Chromium, from a file and without a network. HELFRICH_BROWSER names the browser.
import assert from "node:assert/strict";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const PAGE = new URL("../dist/index.html", import.meta.url).href;
const LONG = 60_000;

/** @type {import("playwright-core").BrowserContext} */ let context;
/** @type {import("playwright-core").Page} */ let page;
let profile = "";
/** @type {string[]} */ const wrong = [];

before(async () => {
  profile = await mkdtemp(join(tmpdir(), "helfrich-web-profile-"));
  context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.HELFRICH_BROWSER,
    headless: true,
    acceptDownloads: true,
    offline: true,
    viewport: { width: 1280, height: 900 },
    args: [
      "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync",
    ],
  });
  page = await context.newPage();
  page.setDefaultTimeout(LONG);
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  page.on("request", (request) => /^https?:/.test(request.url()) && wrong.push(request.url()));
  await page.goto(PAGE);
  await idle();
});
after(async () => {
  await context.close();
  await rm(profile, { recursive: true, force: true });
});

const text = (/** @type {string} */ id) => page.locator(`#${id}`).textContent();
/** Waits until the page has done what was asked. */
const idle = () => page.waitForFunction(() => document.querySelector("#bar .colours, #error:not([hidden])") && !document.body.hasAttribute("aria-busy"));
/** Chooses, and waits. @param {string} id @param {string} value */
async function choose(id, value) {
  await page.selectOption(`#${id}`, value);
  await idle();
}
/** @param {string} id */
async function press(id) {
  await page.click(`#${id}`);
  await idle();
}
/** The bytes that a button downloads. @param {string} id */
async function download(id) {
  const [made] = await Promise.all([page.waitForEvent("download"), page.click(`#${id}`)]);
  await idle();
  return { name: made.suggestedFilename(), bytes: await readFile(await made.path()) };
}
/** Drops a file on the page. @param {string} name @param {Buffer | string} content */
async function drop(name, content) {
  const data = Buffer.from(content).toString("base64");
  await page.evaluate(([name, data]) => {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], name));
    document.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, [name, data]);
  await page.waitForFunction((name) => document.querySelector("#name")?.textContent?.startsWith(name) || !document.querySelector("#error")?.hidden, name);
  await idle();
}
const middle = async () => {
  const box = await page.locator("#canvas").boundingBox();
  assert.ok(box);
  return [box.x + box.width / 2, box.y + box.height / 2];
};
const picture = () => page.evaluate(() => {
  const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("#canvas"));
  return canvas.toDataURL();
});
const frame = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

const OPEN = (() => {
  // A bumpy sheet, whose border has no neighbours on one side.
  const [rows, lines, faces] = [9, [], []];
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < rows; j++) lines.push(`${i} ${j} ${0.2 * Math.sin(i) * Math.cos(j)}`);
  }
  for (let i = 0; i + 1 < rows; i++) {
    for (let j = 0; j + 1 < rows; j++) {
      const at = rows * i + j;
      faces.push(`3 ${at} ${at + rows} ${at + 1}`, `3 ${at + 1} ${at + rows} ${at + rows + 1}`);
    }
  }
  return `ply\nformat ascii 1.0\nelement vertex ${lines.length}\nproperty double x\nproperty double y\nproperty double z\nelement face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n${lines.join("\n")}\n${faces.join("\n")}\n`;
})();
const BOW_TIE = "OFF\n5 2 0\n0 0 0\n1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n3 0 1 2\n3 0 3 4\n";

test("an example is shown with error bars", async () => {
  assert.match(await text("name"), /^discocyte\.ply: 2562 vertices/);
  assert.match(await page.getAttribute("#bar", "aria-label"), /^H in 1\/length, median error bar/);
  assert.match(await page.getAttribute("#histogram", "aria-label"), /2562 values/);
  assert.match(await text("noise"), /none found/);
  assert.equal(await page.locator("#worst li").count(), 12);
});

test("every control has a name, and can be reached by keys", async () => {
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, select, input, canvas, pre")]
    .filter((element) => !(element.labels?.length || element.ariaLabel || (element instanceof HTMLButtonElement && element.textContent)))
    .map((element) => element.outerHTML));
  assert.deepEqual(nameless, []);
  const unreachable = await page.evaluate(() => [...document.querySelectorAll("button, select, input, canvas")]
    .filter((element) => element.tabIndex < 0).map((element) => element.id));
  assert.deepEqual(unreachable, []);
});

test("the surface is turned, zoomed and tapped", async () => {
  const [x, y] = await middle();
  const pictures = [await picture()];
  const changed = async () => {
    await frame();
    pictures.push(await picture());
    assert.notEqual(pictures.at(-1), pictures.at(-2));
  };
  await page.mouse.move(x, y);
  assert.match(await text("hover"), /^vertex \d+: H = \S+ ± \S+ 1\/length$/);
  await page.mouse.click(x, y);
  await page.waitForSelector("#numbers table");
  assert.match(await text("numbers"), /Verdict: clean.*k1/s);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y + 30);
  await page.mouse.up();
  await changed();
  await page.mouse.wheel(0, -300);
  await changed();
  await page.focus("#canvas");
  for (const key of ["ArrowLeft", "ArrowUp", "+", "ArrowRight", "ArrowDown", "-", "0"]) {
    await page.keyboard.press(key);
    await changed();
  }
});

test("two fingers zoom", async () => {
  const [x, y] = await middle();
  const before = await picture();
  const session = await context.newCDPSession(page);
  const touch = (/** @type {string} */ type, /** @type {number} */ apart) => session.send("Input.dispatchTouchEvent", {
    type, touchPoints: apart ? [{ x: x - apart, y, id: 0 }, { x: x + apart, y, id: 1 }] : [],
  });
  await touch("touchStart", 30);
  for (const apart of [40, 60, 90]) await touch("touchMove", apart);
  await touch("touchEnd", 0);
  await frame();
  assert.notEqual(await picture(), before);
  await page.focus("#canvas");
  await page.keyboard.press("0");
});

test("vertices are found by number and from the list", async () => {
  await page.fill("#vertex", "17");
  await page.press("#vertex", "Enter");
  await page.waitForSelector("#numbers table");
  await page.locator("#worst button").first().click();
  const first = (await page.locator("#worst button").first().textContent()).replace("vertex ", "");
  assert.equal(await page.inputValue("#vertex"), first);
});

test("all quantities have colours, and directions are drawn", async () => {
  const quantities = await page.locator("#quantity option").evaluateAll((all) => all.map((option) => option.value));
  for (const wanted of ["H", "K", "k1", "k2", "f", "H_error", "f_error", "sigma"]) assert.ok(quantities.includes(wanted), wanted);
  for (const quantity of ["K", "k1", "k2", "f", "H_error", "H"]) {
    await choose("quantity", quantity);
    assert.ok((await page.getAttribute("#bar", "aria-label")).startsWith(quantity));
  }
  for (const id of ["strokes", "marks"]) {
    const before = await picture();
    await page.click(`#${id}`);
    await frame();
    if (id === "strokes") assert.notEqual(await picture(), before);
  }
  await page.check("#marks");
  await page.uncheck("#strokes");
});

test("two methods are compared, and subtracted", async () => {
  await choose("method1", "gompper-kroll");
  assert.deepEqual(await page.locator("#show option").evaluateAll((all) => all.map((option) => option.value)), ["both", "0", "1", "difference"]);
  for (const show of ["both", "1", "difference"]) {
    await choose("show", show);
    assert.ok((await page.getAttribute("#bar", "aria-label")).includes(show === "difference" ? "gompper-kroll − jet" : "H"));
  }
  assert.match(await text("remarks"), /gompper-kroll does not determine f/);
  await choose("method1", "");
  await choose("method0", "j6");
  assert.match(await text("idea"), /polynomials/);
  await page.uncheck("#errors");
  await idle();
  assert.doesNotMatch(await page.getAttribute("#bar", "aria-label"), /error bar \d/);
  await page.check("#errors");
  await idle();
  await choose("method0", "jet");
});

test("a dropped file is read, and an opened one", async () => {
  await drop("sheet.ply", OPEN);
  assert.match(await text("name"), /^sheet\.ply: 81 vertices, 128 triangles/);
  await page.setInputFiles("#file", { name: "again.ply", mimeType: "", buffer: Buffer.from(OPEN) });
  await page.waitForFunction(() => document.querySelector("#name")?.textContent?.startsWith("again"));
  await idle();
  await press("info");
  assert.match(await text("properties"), /closed +no \(32 boundary edges\)/);
});

test("what is no mesh is refused in words, and repaired", async () => {
  await drop("bow-tie.off", BOW_TIE);
  assert.match(await text("error"), /^bow-tie\.off: .*vertex 0.*helfrich repair/);
  for (const id of ["weld", "outward"]) {
    await page.check(`#${id}`);
    await page.uncheck(`#${id}`);
  }
  await page.fill("#fill", "0");
  await page.fill("#slivers", "0");
  await page.click("#repair");
  await page.waitForFunction(() => /6 vertices/.test(document.querySelector("#name")?.textContent ?? ""));
  await page.waitForFunction(() => !document.body.hasAttribute("aria-busy"));
  assert.match(await text("remarks"), /vertices split where surfaces only touch: 1/);
  await drop("words.txt", "no mesh");
  assert.match(await text("error"), /^words\.txt: unknown format: \.obj/);
});

test("a mesh gets new triangles, and loses its noise", async () => {
  await choose("size", "642");
  await choose("example", "sphere with noise");
  assert.match(await text("noise"), /mean edges/);
  await page.fill("#vertices", "400");
  await press("remesh");
  assert.match(await text("error"), /noise/);
  await page.check("#smooth");
  await press("remesh");
  assert.match(await text("name"), /^sphere with noise\.ply: 400 vertices/);
  assert.match(await text("remarks"), /the noise is removed/);
});

test("the cheapest method is measured", async () => {
  await choose("example", "discocyte");
  await page.fill("#accuracy", "5");
  await page.selectOption("#accurate", "H");
  await page.uncheck("#everywhere");
  await press("recommend");
  assert.match(await text("recommendation"), /H.*\n/s);
  assert.match(await text("recommendation"), /j6/);
});

test("results are saved", async () => {
  for (const [format, content] of [
    ["csv", /^vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz,H_error/],
    ["vtp", /<VTKFile[^]*Name="k1_error"/],
    ["ply", /^ply\n[^]*property uchar red/],
    ["obj", /^v \S+ \S+ \S+ \S+ \S+ \S+\n/m],
  ]) {
    await choose("format", format);
    const { name, bytes } = await download("save");
    assert.equal(name, `discocyte.${format}`);
    assert.match(bytes.toString("latin1"), content);
    if (format === "ply") await drop("saved.ply", bytes);
    if (format === "ply") await choose("example", "torus");
    if (format === "ply") await choose("example", "discocyte");
  }
  const { name, bytes } = await download("png");
  assert.equal(name, "discocyte.png");
  assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  assert.ok(bytes.length > 5000);
});

test("work is cancelled, and the page goes on", async () => {
  await page.selectOption("#size", "40962");
  await page.waitForSelector("#cancel:not([hidden])");
  await page.click("#cancel");
  await page.waitForFunction(() => document.querySelector("#status")?.textContent === "Cancelled.");
  await choose("size", "642");
  assert.match(await text("name"), /642 vertices/);
});

test("a vesicle relaxes to the theory", async () => {
  await page.selectOption("#start", "prolate");
  await page.fill("#reduced", "0.9");
  assert.equal(await text("volume"), "0.90");
  await page.click("#relax");
  await page.waitForFunction(() => /converged\.$/.test(document.querySelector("#relaxed")?.textContent ?? ""));
  await idle();
  const [energy, theory] = (await text("relaxed")).match(/\d\.\d{4}/g).map(Number);
  // Seifert, Berndl and Lipowsky: 1.1896. The mesh is coarse.
  assert.ok(Math.abs(theory - 1.1896) < 2e-3, `theory ${theory}`);
  assert.ok(Math.abs(energy - theory) < 0.02 * theory, `energy ${energy}`);
  assert.match(await page.getAttribute("#energy", "aria-label"), /Energy over 8πκ/);
  // Pressed again it stops.
  await page.fill("#reduced", "0.65");
  await page.selectOption("#start", "oblate");
  await page.click("#relax");
  await page.waitForFunction(() => document.querySelector("#relax")?.textContent === "Stop");
  await page.click("#relax");
  await page.waitForFunction(() => document.querySelector("#relax")?.textContent === "Relax");
  await idle();
  assert.match(await text("name"), /^vesicle\.ply/);
});

test("the page fits screens, light and dark", async () => {
  await choose("size", "2562");
  await choose("example", "discocyte with noise");
  await page.check("#strokes");
  for (const width of [1280, 390]) {
    for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
      await page.setViewportSize({ width, height: width > 800 ? 900 : 844 });
      await page.emulateMedia({ colorScheme });
      await frame();
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= width, `${wide} pixels are too wide for ${width}`);
      const folder = process.env.SCREENSHOTS;
      if (folder) await page.screenshot({ path: join(folder, `page-${width}-${colorScheme}.png`), fullPage: true });
    }
  }
  await page.setViewportSize({ width: 1280, height: 900 });
});

test("nothing went wrong behind the page, and nothing was asked of a network", () => {
  assert.deepEqual(wrong, []);
});
