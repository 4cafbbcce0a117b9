// Computes beside the page. The first message is the module, all others are requests.
import { open } from "./instance.js";

/** @type {ReturnType<typeof open>} */ let ask;
let id = 0;

onmessage = async ({ data }) => {
  if (data.module) {
    ask = open(data.module, (done) => postMessage({ id, done }));
    return;
  }
  const answerer = await ask;
  id = data.id;
  try {
    const answer = answerer(data.request, data.data);
    const buffers = Object.values(answer.arrays).map((array) => array.buffer);
    postMessage({ id, answer }, { transfer: buffers });
  } catch (error) {
    // After a failure of the module itself its memory is not to be trusted.
    const failed = error.repairable === undefined;
    postMessage({ id, message: String(error.message), repairable: !!error.repairable, failed });
  }
};
