// Builds the medial mesh of a file beside the page: takes { name, bytes, primitives }, posts { stage, fraction } while it
// builds, then { built } or { error }.
import init, { Dropped } from "./medial_web.js";

addEventListener("message", async ({ data: { name, bytes, primitives } }) => {
  try {
    await init({ module_or_path: "medial_web_bg.wasm" });
    const watcher = { progress: (stage, fraction) => postMessage({ stage, fraction }) };
    const built = Dropped.build(name, bytes, primitives, watcher);
    const parts = { vertices: built.vertices(), indices: built.indices(), medial: built.baked(), error: built.error() };
    postMessage({ built: parts });
  } catch (error) {
    postMessage({ error: error.message });
  }
});
