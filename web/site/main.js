// The page: takes what the user sets, steps the world sixty times a second, has it drawn.
import init, { Demo } from "./medial_web.js";
import { Renderer } from "./renderer.js";

const SECONDS = 1 / 60;
const says = {
  medial: "Rings hang on the spikes and lean on each other.",
  hulls: "A hull has no hole: rings float above the spikes.",
  parts: "Decomposed into convex parts: coarse, but with holes.",
  triangles: "Triangle meshes are hollow: what is fast can get stuck or pass.",
};
const at = (id) => document.getElementById(id);

async function bytes(file) {
  const answer = await fetch(file);
  if (!answer.ok) throw new Error(`${file}: ${answer.status}`);
  return new Uint8Array(await answer.arrayBuffer());
}

function press(group, key, value) {
  for (const button of at(group).querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String(button.dataset[key] === value));
  }
}

async function main() {
  await init({ module_or_path: "medial_web_bg.wasm" });
  const [ring, creature] = await Promise.all(["ring.medial", "creature.medial"].map(bytes));
  const demo = new Demo(ring, creature, "medial");
  const device = await demo.open_device().then((hardware) => ({ hardware }), ({ message }) => ({ message }));
  const renderer = new Renderer(at("view"), demo.count(), demo.colors());
  // For the test: nothing on the page needs it.
  const state = (window.state = { ready: false });
  let steps = 0;
  let kind = "medial";
  let paused = false;
  let milliseconds = 0;
  let owed = 0;
  let last = performance.now();
  // What the user has asked for, done between two steps: none may begin while the device computes.
  const asked = [];
  const on = (id, event, act) => at(id).addEventListener(event, (e) => asked.push(() => act(e)));

  function refreshSurfaces() {
    const surface = (body) => (at("collider").checked ? demo.collider(body) : demo.source(body));
    renderer.setSurfaces(surface);
  }
  function choose(chosen) {
    demo.set_kind(chosen);
    kind = chosen;
    at("says").textContent = says[kind];
    press("kinds", "kind", kind);
    at("continuous").disabled = kind !== "medial";
    refreshSurfaces();
  }
  function compute(backend) {
    demo.set_gpu(backend === "gpu");
    press("backends", "backend", backend);
  }
  async function step() {
    const start = performance.now();
    if (demo.on_gpu()) await demo.prepare();
    demo.step();
    milliseconds += 0.1 * (performance.now() - start - milliseconds);
    steps += 1;
  }
  function pause(value) {
    paused = value;
    at("pause").textContent = paused ? "Run" : "Pause";
  }
  // Who computes the batches, and why not the device.
  function runs() {
    if (kind !== "medial") return "CPU: the GPU is for medial meshes";
    if (demo.on_gpu()) return device.hardware ? "GPU: WebGPU" : "GPU: WebGPU, itself computed by the CPU";
    const why = device.message ?? demo.device_error();
    at("runs").title = why ?? "";
    return why ? `CPU: ${why.split(":")[0]}` : "CPU";
  }

  on("kinds", "click", ({ target }) => target.dataset.kind && choose(target.dataset.kind));
  on("backends", "click", ({ target }) => target.dataset.backend && compute(target.dataset.backend));
  on("pause", "click", () => pause(!paused));
  on("step", "click", () => {
    pause(true);
    return step();
  });
  on("restart", "click", () => {
    demo.restart();
    steps = 0;
  });
  on("collider", "change", refreshSurfaces);
  on("continuous", "change", ({ target }) => demo.set_continuous(target.checked));

  function show() {
    const poses = demo.poses();
    const settled = demo.settled_by_gpu();
    renderer.draw(poses);
    at("steps").textContent = steps;
    at("milliseconds").textContent = milliseconds.toFixed(2);
    at("tests").textContent = kind === "medial" ? demo.elementary_tests() : "–";
    at("settled").textContent = settled;
    at("contacts").textContent = demo.contact_points();
    at("sleeping").textContent = `${demo.sleeping()} of ${demo.count() - 1}`;
    at("runs").textContent = runs();
    Object.assign(state, { ready: true, steps, kind, poses, settled, on_gpu: demo.on_gpu(), hash: demo.state_hash() });
  }
  async function frame(now) {
    for (const act of asked.splice(0)) await act();
    // After a pause of the page at most four steps are made up for.
    owed = paused ? 0 : Math.min(owed + (now - last) / 1000, 4 * SECONDS);
    last = now;
    for (; owed >= SECONDS; owed -= SECONDS) await step();
    show();
    requestAnimationFrame((now) => frame(now).catch(stop));
  }
  choose("medial");
  at("backends").querySelector("[data-backend=gpu]").disabled = "message" in device;
  compute(device.hardware ? "gpu" : "cpu");
  requestAnimationFrame((now) => frame(now).catch(stop));
}

function stop(error) {
  at("says").textContent = `This page cannot run: ${error.message}`;
  console.error(error);
}

main().catch(stop);
