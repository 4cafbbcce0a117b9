// Requests to the worker, one after the other; a worker that is cancelled is ended and replaced.

/** The work was cancelled. */
export class Cancelled extends Error {}

/** @typedef {{text: any, arrays: Record<string, any>}} Answer */

export class Engine {
  /** @param {string} script @param {ArrayBuffer} module @param {(done: number) => void} progress */
  constructor(script, module, progress) {
    this.address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    this.module = module;
    this.progress = progress;
    this.id = 0;
    /** @type {Map<number, {resolve: (answer: Answer) => void, reject: (error: Error) => void}>} */
    this.waiting = new Map();
    this.begin();
  }

  begin() {
    this.worker = new Worker(this.address);
    this.worker.onmessage = ({ data }) => this.take(data);
    this.worker.postMessage({ module: this.module });
  }

  /** @param {any} data */
  take(data) {
    const waiting = this.waiting.get(data.id);
    if (data.done !== undefined) return this.progress(data.done);
    this.waiting.delete(data.id);
    if (data.answer) return waiting?.resolve(data.answer);
    const error = Object.assign(new Error(data.message), { repairable: data.repairable, failed: data.failed });
    waiting?.reject(error);
  }

  /** @param {object} request @param {Uint8Array} [data] @returns {Promise<Answer>} */
  ask(request, data) {
    const id = ++this.id;
    this.worker.postMessage({ id, request, data });
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  /** Ends all work, and begins without a mesh. */
  cancel() {
    this.worker.terminate();
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    this.begin();
    for (const { reject } of waiting) reject(new Cancelled("cancelled"));
  }
}
