// The page: what is chosen, what is asked of the worker, and what is shown. All words about results are the program's.
import branches from "./branches.json";
import { Cancelled, Engine } from "./engine.js";
import { colourBar, energies, histogram, short, withError } from "./plots.js";
import { SurfaceView } from "./surface.js";

/** @param {string} id @returns {any} */
const $ = (id) => /** @type {any} */ (document.getElementById(id));
/** @param {string} tag @param {object} properties @param {...(Node | string)} children */
const make = (tag, properties, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};
const SIZES = [642, 2562, 10242, 20000, 40962, 100000];
const DEFAULT_SIZE = 2562;
/** Milliseconds of steps of a relaxation between two pictures. */
const STEPS = 60;

/** @type {any} */ let about;
/** @type {Engine} */ let engine;
/** @type {SurfaceView | undefined} */ let view;
/** The mesh of the page: enough to give it to a new worker. @type {any} */
let mesh;
/** What is known of each result. @type {any[]} */
let results = [];
/** The paints that are shown. @type {any[]} */
let shown = [];
let chosen = -1;
let busy = false;
/** The work that was asked for last. */
let last = Promise.resolve();
/** Whether the worker does not have the mesh of the page. */
let isLost = false;
let relaxing = false;

const bytesOf = async (/** @type {string} */ id) => {
  const packed = Uint8Array.from(atob($(id).textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).arrayBuffer();
};

/** @param {string} text */
const say = (text) => {
  $("status").textContent = text;
};

/** @param {Error & {repairable?: boolean}} error */
function tell(error) {
  $("error").textContent = error.message;
  $("error").hidden = false;
  say(error.repairable ? "This is no mesh. Repair can make one of it." : "");
}

/** Runs work with its name after all earlier work; errors are told. @param {string} what @param {() => Promise<void>} work */
function during(what, work) {
  last = last.then(() => run(what, work));
  return last;
}

/** @param {string} what @param {() => Promise<void>} work */
async function run(what, work) {
  busy = true;
  $("error").hidden = true;
  $("progress").removeAttribute("value");
  $("progress").hidden = $("cancel").hidden = false;
  document.body.toggleAttribute("aria-busy", true);
  for (const id of ["recommend", "info", "repair", "remesh", "save"]) $(id).disabled = true;
  say(`${what} …`);
  const start = performance.now();
  try {
    await restore();
    await work();
    if ($("status").textContent === `${what} …`) say(`${what}: ${((performance.now() - start) / 1000).toFixed(1)} s`);
  } catch (error) {
    if (error instanceof Cancelled) say("Cancelled.");
    else tell(error);
    if (error.failed) engine.cancel();
    if (error instanceof Cancelled || error.failed) lose();
  } finally {
    busy = false;
    $("progress").hidden = $("cancel").hidden = true;
    document.body.toggleAttribute("aria-busy", false);
    enable();
  }
}

/** The worker is a new one, which has nothing. */
function lose() {
  isLost = true;
  results = [];
  shown = [];
  view?.setPaints([]);
  $("bar").textContent = $("histogram").textContent = "";
  list([]);
}

/** Gives the mesh to a new worker. */
async function restore() {
  if (!mesh || !isLost) return;
  const data = new Uint8Array(8 * mesh.positions.length + 4 * mesh.triangles.length);
  data.set(new Uint8Array(mesh.positions.buffer), 0);
  data.set(new Uint8Array(mesh.triangles.buffer), 8 * mesh.positions.length);
  await engine.ask({ do: "restore", name: mesh.name, vertices: mesh.positions.length / 3 }, data);
  isLost = false;
}

function enable() {
  const has = !!mesh;
  for (const id of ["recommend", "info", "remesh", "vertex", "png", "format"]) $(id).disabled = !has;
  $("repair").disabled = !has && $("error").hidden;
  $("save").disabled = !results[0];
  $("show").disabled = !results[1];
}

/** Takes the mesh of an answer. @param {any} answer */
function take({ text, arrays }) {
  isLost = false;
  mesh = { name: text.name, few: text.few, remarks: text.remarks, ...arrays };
  results = [];
  shown = [];
  choose(-1);
  $("method1").value = "";
  $("errors").checked = text.few;
  $("name").textContent = `${text.name}: ${text.vertices} vertices, ${arrays.triangles.length / 3} triangles`;
  $("vertices").value = text.vertices;
  $("vertex").max = text.vertices - 1;
  $("properties").hidden = $("recommendation").hidden = $("energy").hidden = true;
  $("relaxed").textContent = "";
  view?.setMesh(arrays.positions, arrays.triangles);
  list([]);
}

/** Ends work that is going on. */
function cancel() {
  relaxing = false;
  if (busy) engine.cancel();
}

/** Loads a mesh, and measures it. @param {string} what @param {object} request @param {Uint8Array} [data] */
const load = (what, request, data) => during(what, async () => {
  let answer;
  try {
    answer = await engine.ask(request, data);
  } catch (error) {
    if (!(error instanceof Cancelled) && /** @type {any} */ (request).do === "read") forget();
    throw error;
  }
  take(answer);
  await evaluate(0);
});

/** No mesh: the file is none. */
function forget() {
  mesh = undefined;
  results = [];
  shown = [];
  $("name").textContent = "No mesh";
  $("bar").textContent = $("histogram").textContent = "";
  view?.setMesh(new Float64Array(), new Uint32Array());
  list([]);
}

/** Asks for the results of a method. @param {number} slot */
async function evaluate(slot) {
  const method = $(`method${slot}`).value;
  results.length = slot;
  if (!method) {
    await paint();
    return;
  }
  const errors = $("errors").checked;
  const answer = await engine.ask({ do: "evaluate", slot, method, errors });
  results[slot] = { ...answer.text, ...answer.arrays };
  if (slot === 0 && $("method1").value) return evaluate(1);
  await paint();
}

/** The words of a method. */
function describe() {
  const method = about.methods.find((/** @type {any} */ known) => known.name === $("method0").value);
  $("idea").textContent = `${method.idea}; time ${short(method.cost)} relative to gompper-kroll (B)`;
}

/** Fills a list of choices, and keeps the choice if it is still there. @param {any} select @param {any[][]} options */
function fill(select, options) {
  const before = select.value;
  select.replaceChildren(...options.map(([value, text]) => make("option", { value, textContent: text })));
  if (options.some(([value]) => String(value) === before)) select.value = before;
}

/** Asks for the colours that are to be shown, and shows them. */
async function paint() {
  const has = results.filter(Boolean);
  enable();
  if (!has.length) {
    shown = [];
    view?.setPaints([]);
    $("bar").textContent = $("histogram").textContent = "";
    return;
  }
  const both = has[1] ? has[0].quantities.filter((/** @type {string} */ name) => has[1].quantities.includes(name)) : has[0].quantities;
  const units = Object.fromEntries(about.quantities.map((/** @type {any} */ quantity) => [quantity.name, quantity.unit]));
  fill($("quantity"), both.map((/** @type {string} */ name) => [name, units[name] ? `${name} in ${units[name]}` : name]));
  fill($("show"), has[1]
    ? [["both", "side by side"], ["0", has[0].method], ["1", has[1].method], ["difference", `${has[1].method} − ${has[0].method}`]]
    : [["0", has[0].method]]);
  const quantity = $("quantity").value;
  const show = $("show").value;
  const slots = show === "both" ? [0, 1] : show === "difference" ? [null] : [Number(show)];
  const answers = [];
  for (const slot of slots) answers.push(await engine.ask({ do: "paint", slot, quantity }));
  shown = answers.map(({ text, arrays }, index) => ({ ...text, ...arrays, slot: slots[index] }));
  // Beside each other, the same colour is the same value.
  const [{ range, map, unit }] = shown;
  view?.setPaints(shown.map(({ painted }) => coloured(painted, range, map)));
  const name = show === "difference" ? `${quantity}: ${has[1].method} − ${has[0].method}` : quantity;
  const title = `${name}${unit ? ` in ${unit}` : ""}${shown[0].error === null ? "" : `, median error bar ${shown[0].error.toPrecision(2)}`}${show === "both" ? `; ${has[0].method} first, then ${has[1].method}` : ""}`;
  $("bar").innerHTML = colourBar(range, title, about.colours.maps[map]);
  $("bar").ariaLabel = `${title}: from ${short(range[0])} to ${short(range[1])}. Grey: twice the error bar is more than this range, or no value.`;
  $("canvas").ariaLabel = `The surface coloured by ${title}`;
  const { label, svg } = histogram(shown[0].values, range, unit);
  $("histogram").innerHTML = svg;
  $("histogram").ariaLabel = label;
  list(shown[0].worst);
  marks();
}

/** Places among the colours, and whether there is one. @param {Float64Array} painted @param {number[]} range @param {string} map */
function coloured(painted, [low, high], map) {
  const place = new Float32Array(painted.length);
  const known = new Float32Array(painted.length);
  painted.forEach((value, i) => {
    if (Number.isNaN(value)) return;
    place[i] = Math.min(1, Math.max(0, (value - low) / (high - low)));
    known[i] = 1;
  });
  return { place, known, map };
}

/** What is said about the mesh and its results. @param {{vertex: number, reason: string}[]} worst */
function list(worst) {
  const known = results.filter(Boolean);
  $("noise").textContent = known.find((result) => result.noise)?.noise ?? "–";
  const remarks = [
    ...(mesh?.remarks ?? []).map((/** @type {string} */ text) => ({ text })),
    ...known.flatMap((result) => result.remarks.map((/** @type {any} */ remark) => ({ ...remark, text: known[1] ? `${result.method}: ${remark.text}` : remark.text }))),
  ];
  if (mesh && known.length && !remarks.length) remarks.push({ text: "nothing is doubtful" });
  $("remarks").replaceChildren(...remarks.map(({ text, warning }) => make("li", { className: warning ? "warning" : "", textContent: text })));
  $("worst").replaceChildren(...worst.map(({ vertex, reason }) => {
    const button = make("button", { type: "button", textContent: `vertex ${vertex}` });
    button.onclick = () => {
      view?.face(vertex);
      choose(vertex);
    };
    const bar = shown[0].errors.length ? withError(shown[0].values[vertex], shown[0].errors[vertex]) : short(shown[0].values[vertex]);
    return make("li", {}, button, ` ${bar}${reason ? `: ${reason}` : ""}`);
  }));
}

/** Marks on the surface: findings of methods, the vertices of the list, and the one that is chosen. */
function marks() {
  if (!mesh || !view) return;
  view.setDirections($("strokes").checked ? results.find((result) => result?.directions)?.directions : undefined);
  const flagged = results.filter(Boolean).flatMap((result) => [...result.flagged]);
  const worst = (shown[0]?.worst ?? []).filter((/** @type {any} */ row) => row.reason).map((/** @type {any} */ row) => row.vertex);
  view.setMarks(Uint32Array.from($("marks").checked ? [...flagged, ...worst] : []), chosen);
}

/** Shows all numbers at a vertex. @param {number} vertex */
async function choose(vertex) {
  chosen = vertex;
  marks();
  $("vertex").value = vertex < 0 ? "" : vertex;
  $("numbers").replaceChildren();
  if (vertex < 0 || !results[0]) return;
  const asked = results.map((_, slot) => engine.ask({ do: "vertex", slot, vertex }));
  /** @type {any[]} */ let answers;
  try {
    answers = (await Promise.all(asked)).map(({ text }) => text);
  } catch {
    return; // The mesh is another one by now.
  }
  const rows = answers[0].rows.map(({ quantity, unit, ...first }) => make("tr", {},
    make("th", { scope: "row", textContent: quantity }),
    ...[first, ...answers.slice(1).map((answer) => answer.rows.find((/** @type {any} */ row) => row.quantity === quantity))]
      .map((cell) => make("td", { textContent: cell ? withError(cell.value, cell.error) : "–" })),
    make("td", { textContent: unit })));
  const head = make("tr", {}, make("th", { scope: "col" }), ...results.map(({ method }) => make("th", { scope: "col", textContent: method })), make("th", { scope: "col", textContent: "unit" }));
  const { verdict, reason } = answers[0];
  $("numbers").replaceChildren(
    make("p", { textContent: verdict ? `Verdict: ${verdict}${reason ? ` (${reason})` : ""}` : "" }),
    make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows)));
}

/** The vertex below the pointer, in words. @param {PointerEvent} event */
function hover(event) {
  const at = event.pointerType === "touch" ? undefined : view?.pick(event.offsetX, event.offsetY);
  const paint = at && shown[at.view];
  $("hover").hidden = !paint;
  if (!paint) return;
  const { vertex } = at;
  $("hover").textContent = `vertex ${vertex}: ${paint.quantity} = ${withError(paint.values[vertex], paint.errors[vertex])} ${paint.unit}`;
  const room = $("stage").clientWidth - $("hover").offsetWidth - 4;
  $("hover").style.left = `${Math.max(0, Math.min(room, event.offsetX + 12))}px`;
  $("hover").style.top = `${Math.max(0, event.offsetY - 34)}px`;
}

/** Turning, zooming and tapping. */
function handle() {
  const canvas = $("canvas");
  /** @type {Map<number, PointerEvent>} */ const down = new Map();
  let moved = 0;
  canvas.onpointerdown = (/** @type {PointerEvent} */ event) => {
    canvas.setPointerCapture(event.pointerId);
    if (!down.size) moved = 0;
    down.set(event.pointerId, event);
    $("hover").hidden = true;
  };
  const spread = () => {
    const [a, b] = [...down.values()];
    return b ? Math.hypot(a.offsetX - b.offsetX, a.offsetY - b.offsetY) : 0;
  };
  canvas.onpointermove = (/** @type {PointerEvent} */ event) => {
    const before = down.get(event.pointerId);
    if (!before) return hover(event);
    const apart = spread();
    down.set(event.pointerId, event);
    const [x, y] = [event.offsetX - before.offsetX, event.offsetY - before.offsetY];
    moved += Math.abs(x) + Math.abs(y);
    if (apart && spread()) view?.zoomBy(spread() / apart);
    else view?.rotate(0.008 * x, 0.008 * y);
  };
  canvas.onpointerup = canvas.onpointercancel = (/** @type {PointerEvent} */ event) => {
    down.delete(event.pointerId);
    if (event.type !== "pointerup" || moved > 6) return;
    const at = view?.pick(event.offsetX, event.offsetY);
    if (at) choose(at.vertex);
  };
  canvas.onpointerleave = () => {
    $("hover").hidden = true;
  };
  canvas.addEventListener("wheel", (/** @type {WheelEvent} */ event) => {
    event.preventDefault();
    view?.zoomBy(Math.exp(-0.0015 * event.deltaY));
  }, { passive: false });
  const keys = /** @type {Record<string, () => void>} */ ({
    ArrowLeft: () => view?.rotate(-0.1, 0),
    ArrowRight: () => view?.rotate(0.1, 0),
    ArrowUp: () => view?.rotate(0, -0.1),
    ArrowDown: () => view?.rotate(0, 0.1),
    "+": () => view?.zoomBy(1.15),
    "=": () => view?.zoomBy(1.15),
    "-": () => view?.zoomBy(1 / 1.15),
    0: () => view?.reset(),
  });
  canvas.onkeydown = (/** @type {KeyboardEvent} */ event) => {
    const act = event.ctrlKey || event.metaKey || event.altKey ? undefined : keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  };
}

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const href = URL.createObjectURL(blob);
  make("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 10_000);
}

/** @param {string} ending */
const fileName = (ending) => `${mesh.name.replace(/(\.gz)?$/i, "").replace(/\.[^.]*$/, "")}${ending}`;

/** The surface and its bar of colours as one picture. */
function picture() {
  view?.drawNow();
  const { canvas } = /** @type {SurfaceView} */ (view);
  const letters = Math.max(14, Math.round(canvas.width / 60));
  const paper = make("canvas", { width: canvas.width, height: canvas.height + 5 * letters });
  const pen = paper.getContext("2d");
  const style = getComputedStyle(document.body);
  pen.fillStyle = style.getPropertyValue("--card");
  pen.fillRect(0, 0, paper.width, paper.height);
  pen.drawImage(canvas, 0, 0);
  if (shown.length) {
    const [{ range, map, quantity, unit }] = shown;
    const colours = about.colours.maps[map];
    const [left, wide] = [letters, (paper.width - 2 * letters) / colours.length];
    colours.forEach((/** @type {number[]} */ colour, /** @type {number} */ i) => {
      pen.fillStyle = `rgb(${colour.join(" ")})`;
      pen.fillRect(left + i * wide, canvas.height + 1.7 * letters, wide + 1, letters);
    });
    pen.fillStyle = style.getPropertyValue("--ink");
    pen.font = `${letters}px sans-serif`;
    pen.fillText(`${quantity}${unit ? ` in ${unit}` : ""}`, left, canvas.height + 1.2 * letters);
    pen.fillText(short(range[0]), left, canvas.height + 4 * letters);
    pen.textAlign = "right";
    pen.fillText(short(range[1]), paper.width - letters, canvas.height + 4 * letters);
  }
  paper.toBlob((/** @type {Blob} */ blob) => download(blob, fileName(".png")));
}

/** Relaxes a vesicle until it rests, or the button is pressed again. */
const relax = () => during("Relaxing", async () => {
  const reduced_volume = Number($("reduced").value);
  const start = $("start").value;
  const answer = await engine.ask({ do: "relax", start, reduced_volume });
  take(answer);
  const history = [answer.text.energy];
  relaxing = true;
  $("relax").textContent = "Stop";
  $("energy").hidden = false;
  const branch = branches.find((/** @type {any} */ known) => known.name === start);
  const theory = at(branch.points, reduced_volume);
  let { end } = answer.text;
  try {
    for (let text = answer.text; ; ) {
      const expected = theory === undefined ? "" : `; theory of the ${start} branch: ${theory.toFixed(4)}`;
      $("energy").innerHTML = energies(branches, reduced_volume, history);
      const words = `Energy over 8πκ: ${text.energy.toFixed(4)} after ${text.iteration} steps${expected}`;
      $("energy").ariaLabel = words;
      $("relaxed").textContent = end ? `${words}. ${end}.` : words;
      if (end || !relaxing) break;
      const stepped = await engine.ask({ do: "step", milliseconds: STEPS });
      text = stepped.text;
      end = text.end;
      history.push(text.energy);
      mesh.positions = stepped.arrays.positions;
      view?.move(mesh.positions);
    }
  } finally {
    relaxing = false;
    $("relax").textContent = "Relax";
  }
  say("Measuring the vesicle …");
  await evaluate(0);
  say("The vesicle is at rest, or was stopped.");
});

/** A value between points of a curve. @param {number[][]} points @param {number} x */
function at(points, x) {
  for (let i = 1; i < points.length; i++) {
    const [[x0, y0], [x1, y1]] = [points[i - 1], points[i]];
    if (x >= x0 && x <= x1) return y0 + ((x - x0) / (x1 - x0)) * (y1 - y0);
  }
  return undefined;
}

async function begin() {
  engine = new Engine($("worker").textContent, await bytesOf("wasm"), (done) => {
    $("progress").value = done;
  });
  about = (await engine.ask({ do: "about" })).text;
  try {
    view = new SurfaceView($("canvas"), about.colours);
  } catch (error) {
    tell(/** @type {Error} */ (error));
  }
  $("version").textContent = about.version;
  $("file").accept = [...about.read, "gz"].map((/** @type {string} */ ending) => `.${ending}`).join(",");
  $("file").title = `${about.readable} files, also compressed as .gz`;
  fill($("example"), about.examples.map((/** @type {string} */ name) => [name, name]));
  fill($("size"), SIZES.map((size) => [size, size]));
  $("size").value = DEFAULT_SIZE;
  const methods = about.methods.map((/** @type {any} */ { name, letter, title }) => [name, `${name}: ${title}${letter ? ` (${letter})` : ""}`]);
  fill($("method0"), methods);
  fill($("method1"), [["", "nothing"], ...methods]);
  $("method0").value = about.methods.find((/** @type {any} */ method) => method.errors).name;
  fill($("accurate"), about.accuracies.map((/** @type {string} */ name) => [name, name]));
  $("accurate").value = about.accuracies.at(-1);
  fill($("format"), ["csv", ...about.written].map((ending) => [ending, `.${ending}`]));
  const [low, high] = about.reduced_volumes;
  Object.assign($("reduced"), { min: low, max: high, value: 0.8 });
  $("volume").textContent = $("reduced").value;
  describe();
  handle();

  const takeExample = () => {
    cancel();
    return load("Example", { do: "example", name: $("example").value, vertices: Number($("size").value) });
  };
  const takeFile = async (/** @type {File} */ file) => {
    cancel();
    if (file) await load(`Reading ${file.name}`, { do: "read", name: file.name }, new Uint8Array(await file.arrayBuffer()));
  };
  $("example").onchange = $("size").onchange = takeExample;
  $("file").onchange = async () => {
    const [file] = $("file").files;
    await takeFile(file);
    $("file").value = "";
  };
  const stop = (/** @type {Event} */ event) => event.preventDefault();
  document.ondragover = (event) => {
    stop(event);
    document.body.classList.add("dropping");
  };
  document.ondragleave = (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  };
  document.ondrop = (event) => {
    stop(event);
    document.body.classList.remove("dropping");
    takeFile(/** @type {any} */ (event.dataTransfer).files[0]);
  };
  const again = (/** @type {number} */ slot) => () => {
    describe();
    if (mesh) during("Measuring", () => evaluate(slot)).then(() => choose(chosen));
  };
  $("method0").onchange = $("errors").onchange = again(0);
  $("method1").onchange = again(1);
  $("quantity").onchange = $("show").onchange = () => during("Colours", paint);
  $("strokes").onchange = $("marks").onchange = marks;
  $("vertex").onchange = () => {
    const vertex = Number($("vertex").value);
    if (mesh && $("vertex").value !== "" && vertex >= 0 && vertex < mesh.positions.length / 3) {
      view?.face(vertex);
      choose(vertex);
    }
  };
  $("cancel").onclick = cancel;
  $("info").onclick = () => during("Properties", async () => {
    $("properties").textContent = (await engine.ask({ do: "info" })).text.text;
    $("properties").hidden = false;
  });
  $("recommend").onclick = () => during("Measuring the methods", async () => {
    const error = Number($("accuracy").value) / 100;
    const request = { do: "recommend", error, quantity: $("accurate").value, everywhere: $("everywhere").checked };
    $("recommendation").textContent = (await engine.ask(request)).text.text;
    $("recommendation").hidden = false;
  });
  $("repair").onclick = () => load("Repairing", {
    do: "repair", weld: $("weld").checked, fill: Number($("fill").value), slivers: Number($("slivers").value), outward: $("outward").checked,
  });
  $("remesh").onclick = () => load("Remeshing", {
    do: "remesh", vertices: $("vertices").value === "" ? null : Number($("vertices").value), smooth: $("smooth").checked,
  });
  $("save").onclick = () => during("Saving", async () => {
    const name = fileName(`.${$("format").value}`);
    const { arrays } = await engine.ask({ do: "save", name, slot: 0, quantity: $("quantity").value });
    download(new Blob([arrays.file]), name);
  });
  $("png").onclick = picture;
  $("reduced").oninput = () => {
    $("volume").textContent = Number($("reduced").value).toFixed(2);
  };
  $("relax").onclick = () => {
    if (relaxing) relaxing = false;
    else relax();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => view?.draw());
  await takeExample();
}

begin().catch(tell);
