// Files: those of the page with the part that is loaded, and those of the user, built in a worker.

// Loads files together; `show` is told the part loaded, in [0, 1].
export async function load(names, show) {
  const loaded = new Map();
  const tell = () => {
    const all = [...loaded.values()];
    const sum = (key) => all.reduce((total, file) => total + file[key], 0);
    if (all.length === names.length) show(sum("have") / Math.max(sum("size"), 1));
  };
  return Promise.all(names.map(async (name) => {
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
    // What is compressed on its way has no length that its bytes could be compared with.
    const plain = !answer.headers.get("Content-Encoding");
    const file = { have: 0, size: plain ? Number(answer.headers.get("Content-Length")) : 0 };
    loaded.set(name, file);
    const chunks = [];
    const reader = answer.body.getReader();
    for (let read = await reader.read(); !read.done; read = await reader.read()) {
      chunks.push(read.value);
      file.have += read.value.length;
      file.size = Math.max(file.size, file.have);
      tell();
    }
    return new Uint8Array(await new Blob(chunks).arrayBuffer());
  }));
}

// Builds a mesh of the user's: { vertices, indices, medial, error }. `show` is told stage and part done; `stop` is an
// AbortSignal that ends the work.
export function build(name, bytes, primitives, show, stop) {
  const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  const built = new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => {
      if (data.error) reject(new Error(data.error));
      else if (data.built) resolve(data.built);
      else show(data.stage, data.fraction);
    };
    worker.onerror = ({ message }) => reject(new Error(message ?? "the worker cannot run"));
    stop.addEventListener("abort", () => reject(stop.reason));
    worker.postMessage({ name, bytes, primitives });
  });
  return built.finally(() => worker.terminate());
}
