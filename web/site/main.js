// The page: takes what the user sets, steps the worlds sixty times a second, has them drawn.
import init, { Demo, Dropped } from "./medial_web.js";
import { build, load } from "./files.js";
import { Renderer } from "./renderer.js";

const SECONDS = 1 / 60;
// Of real time.
const SLOW = 1 / 6;
// Of a mesh of the user's, at most.
const PRIMITIVES = 60;
const KINDS = {
  medial: ["medial meshes", "Rings hang on the spikes and lean on each other."],
  hulls: ["convex hulls", "A hull has no hole: rings float above the spikes."],
  parts: ["convex parts", "Decomposed into convex parts: coarse, but with holes."],
  triangles: ["triangles", "Triangle meshes are hollow: what is fast can get stuck or pass."],
};
const at = (id) => document.getElementById(id);
const isPhone = () => matchMedia("(max-width: 640px)").matches;

function press(group, key, value) {
  for (const button of at(group).querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String(button.dataset[key] === value));
  }
}
const toggle = (id, on) => at(id).setAttribute("aria-pressed", String(on));

async function main() {
  const files = ["medial_web_bg.wasm", "ring.medial", "creature.medial"];
  const [module, ring, creature] = await load(files, (part) => (at("loading").value = part));
  await init({ module_or_path: module });
  const demo = new Demo(ring, creature, "medial");
  const device = await demo.open_device().then((hardware) => ({ hardware }), ({ message }) => ({ message }));
  const renderer = new Renderer(at("view"));
  at("loading").hidden = true;
  at("all").hidden = false;
  // For the test: nothing on the page needs it.
  const state = (window.state = { ready: false });
  // Beside `demo`, with colliders of another kind; made when it is first asked for.
  let other = null;
  let split = false;
  let dropped = null;
  let steps = 0;
  let kind = "medial";
  let paused = false;
  let slow = false;
  let milliseconds = 0;
  let owed = 0;
  let last = performance.now();
  let building = null;
  // What the user has asked for, done between two steps: none may begin while the device computes.
  const asked = [];
  const ask = (act) => asked.push(act);
  const on = (id, event, act) => at(id).addEventListener(event, (e) => ask(() => act(e)));

  const demos = () => (split ? [demo, other] : [demo]);
  const beside = () => (kind === "hulls" ? "medial" : "hulls");

  function refreshSurfaces() {
    const drawn = at("collider").checked;
    renderer.setSurfaces(demos().map((demo) => {
      const surface = (body) => (drawn ? demo.collider(body) : demo.source(body));
      return { falling: surface(0), creature: surface(demo.creature()) };
    }));
  }
  function says() {
    at("says").textContent = split ? "The same start, the same throws, other colliders." : KINDS[kind][1];
  }
  function choose(chosen) {
    demo.set_kind(chosen);
    kind = chosen;
    if (split) other.set_kind(beside());
    press("kinds", "kind", kind);
    at("continuous").disabled = kind !== "medial";
    says();
    refreshSurfaces();
  }
  function restart() {
    demos().forEach((demo) => demo.restart());
    steps = 0;
  }
  // Both begin anew: a comparison from the same start.
  function compare(both) {
    split = both;
    toggle("split", split);
    if (split) {
      if (!other) {
        other = new Demo(ring, creature, beside());
        if (dropped) other.set_falling(dropped);
      }
      other.set_kind(beside());
      restart();
    }
    says();
    refreshSurfaces();
  }
  function setDrawn(value) {
    at("collider").checked = value;
    refreshSurfaces();
  }
  function setSlow(value) {
    slow = value;
    toggle("slow", slow);
  }
  function compute(backend) {
    demo.set_gpu(backend === "gpu");
    press("backends", "backend", backend);
  }
  function throwAlong({ from, along }) {
    demos().forEach((demo) => demo.throw(from, along));
  }
  async function step() {
    const start = performance.now();
    if (demo.on_gpu()) await demo.prepare();
    demo.step();
    milliseconds += 0.1 * (performance.now() - start - milliseconds);
    if (split) other.step();
    steps += 1;
  }
  function pause(value) {
    paused = value;
    at("pause").textContent = paused ? "Run" : "Pause";
  }
  function stepOnce() {
    pause(true);
    return step();
  }
  function fold(folded) {
    at("more").hidden = folded;
    at("fold").setAttribute("aria-expanded", String(!folded));
    at("fold").title = folded ? "Unfold the panel" : "Fold the panel";
  }
  // What falls: a mesh of the user's, or rings where there is none.
  function letFall(mesh, name) {
    for (const one of [demo, other].filter(Boolean)) {
      if (mesh) one.set_falling(mesh);
      else one.set_rings();
    }
    dropped = mesh;
    at("own").textContent = mesh ? name : "your mesh …";
    toggle("own", mesh !== null);
    toggle("rings", mesh === null);
    steps = 0;
    says();
    refreshSurfaces();
  }
  async function take(file) {
    if (!file || building) return;
    building = new AbortController();
    fold(false);
    at("building").hidden = false;
    at("built").value = 0;
    at("stage").textContent = "reading";
    const show = (stage, fraction) => {
      at("stage").textContent = stage;
      at("built").value = fraction;
      state.told = (state.told ?? 0) + 1;
    };
    try {
      const bytes = new Uint8Array(await file.arrayBuffer());
      building.signal.throwIfAborted();
      const { vertices, indices, medial, error } = await build(file.name, bytes, PRIMITIVES, show, building.signal);
      const mesh = new Dropped(vertices, indices, medial, error);
      ask(() => {
        try {
          letFall(mesh, file.name);
          const triangles = indices.length / 3;
          at("says").textContent = `${file.name}: ${triangles} triangles, off by ${(100 * error).toFixed(1)} % at most.`;
        } catch (refused) {
          at("says").textContent = `${file.name}: ${refused.message}`;
        }
      });
    } catch (error) {
      at("says").textContent = `${file.name}: ${error.message}`;
    } finally {
      building = null;
      at("building").hidden = true;
      at("file").value = "";
    }
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
  on("step", "click", stepOnce);
  on("restart", "click", restart);
  on("split", "click", () => compare(!split));
  on("slow", "click", () => setSlow(!slow));
  on("throw", "click", () => throwAlong(renderer.middleRay()));
  on("rings", "click", () => letFall(null));
  on("collider", "change", refreshSurfaces);
  on("continuous", "change", ({ target }) => demo.set_continuous(target.checked));
  at("fold").addEventListener("click", () => fold(!at("more").hidden));
  at("own").addEventListener("click", () => at("file").click());
  at("file").addEventListener("change", ({ target }) => take(target.files[0]));
  at("cancel").addEventListener("click", () => building?.abort(new Error("cancelled")));
  renderer.onClick = (ray) => ask(() => throwAlong(ray));

  let within = 0;
  const dragged = (event, by) => {
    event.preventDefault();
    within = by === 0 ? 0 : within + by;
    at("drop").hidden = within === 0;
  };
  addEventListener("dragenter", (event) => dragged(event, 1));
  addEventListener("dragleave", (event) => dragged(event, -1));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    dragged(event, 0);
    take(event.dataTransfer.files[0]);
  });

  const keys = {
    " ": () => pause(!paused),
    ".": stepOnce,
    r: restart,
    c: () => compare(!split),
    t: () => throwAlong(renderer.middleRay()),
    l: () => setSlow(!slow),
    d: () => setDrawn(!at("collider").checked),
    1: () => choose("medial"),
    2: () => choose("hulls"),
    3: () => choose("parts"),
    4: () => choose("triangles"),
    ArrowLeft: () => renderer.turnBy(-0.1, 0),
    ArrowRight: () => renderer.turnBy(0.1, 0),
    ArrowUp: () => renderer.turnBy(0, 0.1),
    ArrowDown: () => renderer.turnBy(0, -0.1),
    "+": () => renderer.zoomBy(0.9),
    "=": () => renderer.zoomBy(0.9),
    "-": () => renderer.zoomBy(1 / 0.9),
  };
  addEventListener("keydown", (event) => {
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    // A button in focus takes the space bar for itself.
    const taken = event.target.closest?.("button, input, a") && [" ", "Enter"].includes(event.key);
    if (!act || taken || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    ask(act);
  });

  function show() {
    const poses = demo.poses();
    const settled = demo.settled_by_gpu();
    const panel = at("panel").getBoundingClientRect();
    const covered = isPhone() ? { left: 0, bottom: panel.height } : { left: panel.right, bottom: 0 };
    const places = renderer.draw(demos().map((demo) => {
      return { poses: demo.poses(), colors: demo.colors(), creature: demo.creature() };
    }), covered);
    ["left", "right"].forEach((side, k) => {
      const name = at(`name-${side}`);
      name.hidden = !split;
      if (!split) return;
      name.textContent = KINDS[k === 0 ? kind : beside()][0];
      Object.assign(name.style, { left: `${places[k].x}px`, top: `${places[k].top + 10}px` });
    });
    at("steps").textContent = steps;
    at("milliseconds").textContent = milliseconds.toFixed(2);
    at("tests").textContent = kind === "medial" ? demo.elementary_tests() : "–";
    at("settled").textContent = settled;
    at("contacts").textContent = demo.contact_points();
    at("sleeping").textContent = `${demo.sleeping()} of ${demo.count() - 1}`;
    at("runs").textContent = runs();
    Object.assign(state, {
      ready: true, steps, kind, split, slow, paused, poses, settled, on_gpu: demo.on_gpu(), hash: demo.state_hash(),
      beside: split ? other.poses() : null, turn: renderer.turn, distance: renderer.distance,
    });
  }
  async function frame(now) {
    for (const act of asked.splice(0)) await act();
    // After a pause of the page at most four steps are made up for.
    const passed = ((now - last) / 1000) * (slow ? SLOW : 1);
    owed = paused ? 0 : Math.min(owed + passed, 4 * SECONDS);
    last = now;
    for (; owed >= SECONDS; owed -= SECONDS) await step();
    show();
    requestAnimationFrame((now) => frame(now).catch(stop));
  }
  fold(isPhone());
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
