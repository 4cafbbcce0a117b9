// The surface in WebGL: colours, strokes and marks, one view or two beside each other, turned and zoomed together.
import { createBufferInfoFromArrays, createProgramInfo, createTexture, drawBufferInfo, m4, setBuffersAndAttributes, setUniforms } from "twgl.js";

const SURFACE = [
  `#version 300 es
  uniform mat4 camera; uniform mat4 turn;
  in vec3 position; in vec3 normal; in float place; in float known;
  out vec3 n; out float p; out float k;
  void main() { gl_Position = camera * vec4(position, 1.0); n = mat3(turn) * normal; p = place; k = known; }`,
  `#version 300 es
  precision highp float;
  uniform sampler2D colours; uniform vec3 missing;
  in vec3 n; in float p; in float k; out vec4 colour;
  void main() {
    vec3 normal = normalize(gl_FrontFacing ? n : -n);
    float light = 0.45 + 0.55 * max(dot(normal, normalize(vec3(0.25, 0.45, 0.85))), 0.0);
    vec3 own = texture(colours, vec2((p * 255.0 + 0.5) / 256.0, 0.5)).rgb;
    colour = vec4(light * (k > 0.999 ? own : missing), 1.0);
  }`,
];
const LINES = [
  `#version 300 es
  uniform mat4 camera; uniform float size;
  in vec3 position;
  void main() { gl_Position = camera * vec4(position, 1.0); gl_PointSize = size; }`,
  `#version 300 es
  precision highp float;
  uniform vec4 paint; uniform bool round; out vec4 colour;
  void main() {
    if (round && length(gl_PointCoord - 0.5) > 0.5) discard;
    colour = paint;
  }`,
];
const STROKES = 1500;

/** @typedef {{place: Float32Array, known: Float32Array, map: string}} Paint */

export class SurfaceView {
  /** @param {HTMLCanvasElement} canvas @param {any} colours maps and the colour of missing values, as bytes */
  constructor(canvas, colours) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("this browser shows no WebGL 2: the numbers are computed, and no surface is drawn");
    this.gl = gl;
    this.surface = createProgramInfo(gl, SURFACE);
    this.lines = createProgramInfo(gl, LINES);
    this.missing = colours.missing.map((/** @type {number} */ part) => part / 255);
    /** @type {Record<string, WebGLTexture>} */ this.maps = {};
    for (const [name, map] of Object.entries(colours.maps)) {
      const src = new Uint8Array(/** @type {number[][]} */ (map).flatMap((colour) => [...colour, 255]));
      this.maps[name] = createTexture(gl, { src, width: 256, height: 1, auto: false, min: gl.LINEAR, mag: gl.LINEAR, wrap: gl.CLAMP_TO_EDGE });
    }
    /** @type {Paint[]} */ this.paints = [];
    this.marked = new Uint32Array();
    this.chosen = -1;
    this.reset();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** All of the surface, from above and to the side. */
  reset() {
    this.turn = m4.multiply(m4.rotationX(-1.05), m4.rotationZ(0.5));
    this.zoom = 1;
    this.draw();
  }

  /** @param {Float64Array} positions @param {Uint32Array} triangles */
  setMesh(positions, triangles) {
    this.triangles = triangles;
    this.move(positions);
    this.paints = [];
    this.directions = undefined;
    this.marked = new Uint32Array();
    this.chosen = -1;
    this.reset();
  }

  /** New positions of the same mesh. @param {Float64Array} positions */
  move(positions) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    positions.forEach((x, i) => {
      low[i % 3] = Math.min(low[i % 3], x);
      high[i % 3] = Math.max(high[i % 3], x);
    });
    const centre = low.map((x, i) => (x + high[i]) / 2);
    let radius = 0;
    for (let i = 0; i < positions.length; i += 3) {
      radius = Math.max(radius, Math.hypot(positions[i] - centre[0], positions[i + 1] - centre[1], positions[i + 2] - centre[2]));
    }
    this.points = Float32Array.from(positions, (x, i) => (x - centre[i % 3]) / (radius || 1));
    this.normals = normals(this.points, this.triangles);
    this.buffers = undefined;
    this.draw();
  }

  /** One view, or two. @param {Paint[]} paints */
  setPaints(paints) {
    this.paints = paints;
    this.buffers = undefined;
    this.draw();
  }

  /** Six numbers for each vertex, NaN where there are none. @param {Float64Array | undefined} directions */
  setDirections(directions) {
    this.directions = directions;
    this.buffers = undefined;
    this.draw();
  }

  /** @param {Uint32Array} marked @param {number} chosen */
  setMarks(marked, chosen) {
    this.marked = marked;
    this.chosen = chosen;
    this.buffers = undefined;
    this.draw();
  }

  make() {
    const gl = this.gl;
    const views = this.paints.length || 1;
    for (const buffer of this.made ?? []) gl.deleteBuffer(buffer);
    const count = this.points.length / 3;
    const none = { place: new Float32Array(count), known: new Float32Array(count) };
    const raised = (/** @type {ArrayLike<number>} */ vertices) => {
      const points = new Float32Array(3 * vertices.length);
      for (let i = 0; i < vertices.length; i++) {
        for (let k = 0; k < 3; k++) {
          points[3 * i + k] = this.points[3 * vertices[i] + k] + 0.004 * this.normals[3 * vertices[i] + k];
        }
      }
      return points;
    };
    const info = (/** @type {Float32Array} */ points) =>
      points.length ? createBufferInfoFromArrays(gl, { position: { numComponents: 3, data: points } }) : undefined;
    this.buffers = {
      surfaces: Array.from({ length: views }, (_, view) => {
        const { place, known } = this.paints[view] ?? none;
        return createBufferInfoFromArrays(gl, {
          position: { numComponents: 3, data: this.points },
          normal: { numComponents: 3, data: this.normals },
          place: { numComponents: 1, data: place },
          known: { numComponents: 1, data: known },
          indices: { numComponents: 3, data: this.triangles },
        });
      }),
      strokes: info(this.strokes()),
      marks: info(raised(this.marked)),
      chosen: info(raised(this.chosen >= 0 ? [this.chosen] : [])),
    };
    const all = [...this.buffers.surfaces, this.buffers.strokes, this.buffers.marks, this.buffers.chosen];
    this.made = all.filter(Boolean).flatMap((/** @type {any} */ made) =>
      [...Object.values(made.attribs).map((/** @type {any} */ attrib) => attrib.buffer), made.indices].filter(Boolean));
  }

  /** Ends of lines along the principal directions, of some vertices. */
  strokes() {
    const directions = this.directions;
    if (!directions) return new Float32Array();
    const count = this.points.length / 3;
    const step = Math.max(1, Math.ceil(count / STROKES));
    const length = Math.min(0.09, 1.1 / Math.sqrt(count / step));
    const ends = [];
    for (let vertex = 0; vertex < count; vertex += step) {
      for (const [offset, part] of [[0, 1], [3, 0.45]]) {
        if (Number.isNaN(directions[6 * vertex + offset])) continue;
        for (const sign of [-1, 1]) {
          for (let k = 0; k < 3; k++) {
            const at = this.points[3 * vertex + k] + 0.006 * this.normals[3 * vertex + k];
            ends.push(at + 0.5 * sign * length * part * directions[6 * vertex + offset + k]);
          }
        }
      }
    }
    return new Float32Array(ends);
  }

  /** The transformation of a view. @param {number} aspect width over height */
  camera(aspect) {
    const [x, y] = aspect > 1 ? [1 / aspect, 1] : [1, aspect];
    const scale = 0.92 * this.zoom;
    return m4.multiply(m4.scaling([scale * x, scale * y, -0.4]), this.turn);
  }

  /** The rectangles of the views in pixels of the canvas. */
  views() {
    const { width, height } = this.canvas;
    const count = this.paints.length || 1;
    const wide = width >= height;
    return Array.from({ length: count }, (_, view) => wide
      ? [Math.round((view * width) / count), 0, Math.round(width / count), height]
      : [0, Math.round(((count - 1 - view) * height) / count), width, Math.round(height / count)]);
  }

  draw() {
    cancelAnimationFrame(this.frame ?? 0);
    this.frame = requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    const { gl, canvas } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(ratio * size)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.points) return;
    if (!this.buffers) this.make();
    gl.enable(gl.DEPTH_TEST);
    const { surfaces, strokes, marks, chosen } = /** @type {any} */ (this.buffers);
    const mark = rgb(getComputedStyle(canvas).getPropertyValue("--mark"));
    this.views().forEach(([x, y, wide, high], view) => {
      gl.viewport(x, y, wide, high);
      const camera = this.camera(wide / high);
      gl.useProgram(this.surface.program);
      setBuffersAndAttributes(gl, this.surface, surfaces[view]);
      setUniforms(this.surface, {
        camera, turn: this.turn, missing: this.missing,
        colours: this.maps[this.paints[view]?.map] ?? Object.values(this.maps)[0],
      });
      drawBufferInfo(gl, surfaces[view]);
      gl.useProgram(this.lines.program);
      for (const [buffer, kind, paint, size] of [
        [strokes, gl.LINES, [0.05, 0.05, 0.05, 1], 1],
        [marks, gl.POINTS, [...mark, 1], 5 * ratio],
        [chosen, gl.POINTS, [...mark, 1], 11 * ratio],
      ]) {
        if (!buffer) continue;
        setBuffersAndAttributes(gl, this.lines, buffer);
        setUniforms(this.lines, { camera, size, paint, round: kind === gl.POINTS });
        drawBufferInfo(gl, buffer, kind);
      }
    });
  }

  /** The vertex at a place of the canvas in CSS pixels, and its view; none farther than a few pixels away. @param {number} left @param {number} top */
  pick(left, top) {
    if (!this.points) return undefined;
    const ratio = this.canvas.width / this.canvas.clientWidth;
    const [px, py] = [left * ratio, this.canvas.height - top * ratio];
    const views = this.views();
    const view = views.findIndex(([x, y, wide, high]) => px >= x && px < x + wide && py >= y && py < y + high);
    if (view < 0) return undefined;
    const [x, y, wide, high] = views[view];
    const camera = this.camera(wide / high);
    // The nearest of the vertices that face the viewer, in front of others that are as near.
    let [best, least] = [-1, (14 * ratio) ** 2];
    let front = Infinity;
    const { points, normals } = this;
    for (let at = 0; at < points.length; at += 3) {
      const to = (/** @type {number} */ row) =>
        camera[row] * points[at] + camera[4 + row] * points[at + 1] + camera[8 + row] * points[at + 2];
      const dx = x + ((to(0) + 1) / 2) * wide - px;
      const dy = y + ((to(1) + 1) / 2) * high - py;
      const square = dx * dx + dy * dy;
      if (square > (14 * ratio) ** 2) continue;
      const facing = camera[2] * normals[at] + camera[6] * normals[at + 1] + camera[10] * normals[at + 2];
      if (facing > 0) continue;
      const depth = to(2);
      const isBefore = depth < front - 0.08;
      if (isBefore || (square < least && depth < front + 0.08)) {
        [best, least, front] = [at / 3, square, depth];
      }
    }
    return best < 0 ? undefined : { vertex: best, view };
  }

  /** Turns by angles across and along the screen. @param {number} across @param {number} along */
  rotate(across, along) {
    this.turn = m4.multiply(m4.multiply(m4.rotationX(along), m4.rotationY(across)), this.turn);
    this.draw();
  }

  /** @param {number} factor */
  zoomBy(factor) {
    this.zoom = Math.min(50, Math.max(0.3, this.zoom * factor));
    this.draw();
  }

  /** Turns a vertex to the front. @param {number} vertex */
  face(vertex) {
    const [x, y, z] = m4.transformDirection(this.turn, this.normals.slice(3 * vertex, 3 * vertex + 3));
    this.rotate(-Math.atan2(x, Math.hypot(y, z) && z), 0);
    const turned = m4.transformDirection(this.turn, this.normals.slice(3 * vertex, 3 * vertex + 3));
    this.rotate(0, Math.atan2(turned[1], turned[2]));
  }
}

/** Normals at vertices, weighted by areas. @param {Float32Array} points @param {Uint32Array} triangles */
function normals(points, triangles) {
  const sums = new Float32Array(points.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const [ux, uy, uz] = [points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]];
    const [vx, vy, vz] = [points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]];
    const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const at of [a, b, c]) {
      sums[at] += nx;
      sums[at + 1] += ny;
      sums[at + 2] += nz;
    }
  }
  for (let i = 0; i < sums.length; i += 3) {
    const length = Math.hypot(sums[i], sums[i + 1], sums[i + 2]) || 1;
    for (let k = 0; k < 3; k++) sums[i + k] /= length;
  }
  return sums;
}

/** Parts from 0 to 1 of a colour `#rrggbb`. @param {string} text */
function rgb(text) {
  const number = Number.parseInt(text.trim().slice(1), 16) || 0;
  return [16, 8, 0].map((shift) => ((number >> shift) & 255) / 255);
}
