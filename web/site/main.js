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

async function main() {
  await init({ module_or_path: "medial_web_bg.wasm" });
  const [ring, creature] = await Promise.all(["ring.medial", "creature.medial"].map(bytes));
  const demo = new Demo(ring, creature, "medial");
  const renderer = new Renderer(at("view"), demo.count(), demo.colors());
  // For the test: nothing on the page needs it.
  const state = (window.state = { steps: 0, kind: "medial", ready: false, poses: () => demo.poses() });
  let paused = false;
  let milliseconds = 0;
  let owed = 0;
  let last = performance.now();

  function refreshSurfaces() {
    const surface = (body) => (at("collider").checked ? demo.collider(body) : demo.source(body));
    renderer.setSurfaces(surface);
  }
  function choose(kind) {
    demo.set_kind(kind);
    state.kind = kind;
    at("says").textContent = says[kind];
    for (const button of at("kinds").querySelectorAll("button")) {
      button.setAttribute("aria-pressed", String(button.dataset.kind === kind));
    }
    at("continuous").disabled = kind !== "medial";
    refreshSurfaces();
  }
  function step() {
    const start = performance.now();
    demo.step();
    milliseconds += 0.1 * (performance.now() - start - milliseconds);
    state.steps += 1;
  }
  function pause(value) {
    paused = value;
    at("pause").textContent = paused ? "Run" : "Pause";
  }

  at("kinds").addEventListener("click", (event) => {
    const kind = event.target.dataset.kind;
    if (kind) choose(kind);
  });
  at("pause").addEventListener("click", () => pause(!paused));
  at("step").addEventListener("click", () => {
    pause(true);
    step();
  });
  at("restart").addEventListener("click", () => {
    demo.restart();
    state.steps = 0;
  });
  at("collider").addEventListener("change", refreshSurfaces);
  at("continuous").addEventListener("change", (event) => demo.set_continuous(event.target.checked));

  function frame(now) {
    // After a pause of the page at most four steps are made up for.
    owed = paused ? 0 : Math.min(owed + (now - last) / 1000, 4 * SECONDS);
    last = now;
    for (; owed >= SECONDS; owed -= SECONDS) step();
    renderer.draw(demo.poses());
    at("steps").textContent = state.steps;
    at("milliseconds").textContent = milliseconds.toFixed(2);
    at("tests").textContent = state.kind === "medial" ? demo.elementary_tests() : "–";
    at("contacts").textContent = demo.contact_points();
    at("sleeping").textContent = `${demo.sleeping()} of ${demo.count() - 1}`;
    state.sleeping = demo.sleeping();
    state.ready = true;
    requestAnimationFrame(frame);
  }
  choose("medial");
  requestAnimationFrame(frame);
}

main().catch((error) => {
  at("says").textContent = `This page cannot run: ${error.message}`;
  console.error(error);
});
