// The module of WebAssembly: requests in JSON and bytes, answers in JSON and arrays. Used by the worker and by tests.

/** The program's own message instead of an answer. */
export class Refusal extends Error {
  /** @param {string} message @param {boolean} repairable */
  constructor(message, repairable) {
    super(message);
    this.repairable = repairable;
  }
}

/**
 * @param {BufferSource} bytes the module
 * @param {(done: number) => void} progress
 * @returns {Promise<(request: object, data?: Uint8Array) => {text: any, arrays: Record<string, any>}>}
 */
export async function open(bytes, progress) {
  const texts = new TextDecoder();
  /** @type {any} */ let exports;
  const view = (/** @type {number} */ at, /** @type {number} */ length) =>
    new Uint8Array(exports.memory.buffer, at, length);
  const page = {
    progress,
    milliseconds: () => performance.now(),
    panicked: (/** @type {number} */ at, /** @type {number} */ length) => {
      throw new Error(texts.decode(view(at, length)));
    },
  };
  exports = (await WebAssembly.instantiate(bytes, { page })).instance.exports;
  exports.start();
  const given = (/** @type {Uint8Array} */ data) => {
    const at = exports.allocate(data.length);
    view(at, data.length).set(data);
    return [at, data.length];
  };
  const part = (/** @type {number} */ number) =>
    view(exports.part_address(number), exports.part_length(number)).slice();
  return (request, data = new Uint8Array()) => {
    exports.ask(...given(new TextEncoder().encode(JSON.stringify(request))), ...given(data));
    const answer = JSON.parse(texts.decode(part(0)));
    if (answer.refusal !== undefined) throw new Refusal(answer.refusal, answer.repairable);
    const classes = /** @type {any} */ ({ Float64Array, Uint32Array, Uint8Array });
    /** @type {Record<string, any>} */ const arrays = {};
    answer.arrays.forEach(([name, kind], /** @type {number} */ index) => {
      arrays[name] = new classes[kind](part(index + 1).buffer);
    });
    return { text: answer.text, arrays };
  };
}
