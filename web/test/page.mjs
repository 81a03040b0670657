// The page end to end in a headless Chromium: node test/page.mjs FOLDER PICTURES. It loads, the rings fall
// and come to rest, clicks switch what bodies collide as, all that the user can do is done (`features.mjs`), and nothing
// is written as an error. Worlds end
// the same, bit by bit, on the GPU as on the CPU, and without WebGPU the CPU serves.
import assert from "node:assert/strict";
import { mkdir, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { serve } from "../serve.mjs";
import { launch } from "./chromium.mjs";
import { PATIENCE, fast, folding, keys, moved, ownMesh, places, poses, pressed, sideBySide, slowMotion, throwing, zooming } from "./features.mjs";

const [folder, pictures] = process.argv.slice(2);
const SIZES = {
  laptop: { width: 1366, height: 768, mobile: false },
  phone: { width: 390, height: 844, mobile: true },
};

const server = await serve(folder, 0);
const url = `http://localhost:${server.address().port}/`;
await mkdir(pictures, { recursive: true });
const browser = await launch();

const heights = (poses) => places(poses).map(([, y]) => y);

async function drawn(page) {
  // What is on the canvas is no single colour: at least as many as a few bodies, ground and sky have.
  return page.value(`new Promise((resolve) => requestAnimationFrame(() => {
    const canvas = document.getElementById("view");
    const copy = new OffscreenCanvas(64, 64).getContext("2d");
    copy.drawImage(canvas, 0, 0, 64, 64);
    const { data } = copy.getImageData(0, 0, 64, 64);
    resolve(new Set(Array.from({ length: 4096 }, (_, k) => data.slice(4 * k, 4 * k + 3).join())).size);
  }))`);
}

// The scene from its start on a backend: after each of some numbers of steps the hash of all bodies'
// states, and how many jobs the GPU has answered.
async function run_on(page, backend) {
  await page.click("#step");
  await page.click(`[data-backend=${backend}]`);
  await page.click("#restart");
  await page.until(`state.steps === 0 && state.on_gpu === ${backend === "gpu"}`, PATIENCE);
  assert.equal(await pressed(page, `[data-backend=${backend}]`), "true");
  const hashes = [await page.value("state.hash")];
  for (const steps of [60, 60, 120, 240]) {
    await fast(page, steps);
    hashes.push(await page.value("state.hash"));
  }
  assert.equal(await page.value("state.steps"), 480);
  return { hashes, settled: await page.value("state.settled"), says: await page.value("document.getElementById('runs').textContent") };
}

async function backends() {
  const page = await browser.open(url, SIZES.laptop);
  await page.until("window.state?.ready", PATIENCE);
  const device = await run_on(page, "gpu");
  await writeFile(join(pictures, "laptop-gpu.png"), await page.picture());
  const cpu = await run_on(page, "cpu");
  assert.match(device.says, /^GPU/);
  assert.match(cpu.says, /^CPU/);
  assert.equal(new Set(cpu.hashes).size, 5, "the world moves");
  assert.deepEqual(device.hashes, cpu.hashes, "worlds are the same on either backend");
  assert.ok(device.settled > 0, "the GPU answers");
  assert.equal(cpu.settled, 0);
  // In mid-run, and with colliders that have nothing for it.
  await page.click("[data-backend=gpu]");
  await fast(page, 10);
  await page.click("[data-kind=hulls]");
  await fast(page, 10);
  await page.click("[data-kind=medial]");
  await fast(page, 10);
  assert.ok(await page.value("state.on_gpu"), "the device goes from stage to stage");
  assert.deepEqual(page.errors, [], "no error on the console");
  await page.close();
  console.log(`backends: ${device.hashes.at(-1)} on both after 480 steps, ${device.settled} jobs answered by the GPU`);
}

async function no_webgpu() {
  const page = await browser.open(url, SIZES.phone, "Object.defineProperty(navigator, 'gpu', { value: undefined })");
  await page.until("window.state?.ready", PATIENCE);
  await page.click("#fold");
  assert.match(await page.value("document.getElementById('runs').textContent"), /^CPU: no GPU adapter$/);
  assert.ok(await page.value("document.querySelector('[data-backend=gpu]').disabled"));
  await fast(page, 60);
  assert.ok(heights(await poses(page)).every(Number.isFinite));
  assert.deepEqual(page.errors, [], "no error on the console");
  await writeFile(join(pictures, "phone-no-webgpu.png"), await page.picture());
  await page.close();
}

async function at_size(name) {
  const page = await browser.open(url, SIZES[name]);
  await page.until("window.state?.ready", PATIENCE);
  assert.ok(await page.value("document.getElementById('loading').hidden && document.getElementById('loading').value === 1"), "all was loaded");
  await writeFile(join(pictures, `${name}-start.png`), await page.picture());
  await folding(page, SIZES[name].mobile);
  // On a slow machine a running scene would have gone on before it is looked at.
  await page.click("#pause");
  await page.click("#restart");
  await page.until("state.paused && state.steps === 0", PATIENCE);
  const start = await poses(page);
  assert.equal(start.length, 7 * 16, "fifteen rings and the creature");
  await page.click("#pause");
  await page.until("state.steps >= 60", PATIENCE);
  const later = await poses(page);
  const falls = moved(start, later);
  assert.ok(falls.slice(0, -1).every((metres) => metres > 0.3), `each ring falls: ${falls}`);
  assert.equal(falls.at(-1), 0, "the creature stands");
  assert.ok((await drawn(page)) > 100, "something is drawn");

  await fast(page, 900 - (await page.value("state.steps")));
  const rest = await poses(page);
  await fast(page, 60);
  const end = await poses(page);
  assert.ok(end.every(Number.isFinite), "poses are numbers");
  assert.ok(Math.max(...moved(rest, end)) < 0.01, `rings rest: ${moved(rest, end)}`);
  assert.ok(heights(end).every((y) => y > -0.02), `none is under the ground: ${heights(end)}`);
  const hung = heights(end).slice(0, -1).filter((y) => y > 0.3).length;
  assert.ok(hung >= 1, "a ring hangs");
  await writeFile(join(pictures, `${name}-medial.png`), await page.picture());

  await page.click("[data-kind=hulls]");
  await page.until("state.kind === 'hulls'", PATIENCE);
  assert.equal(await pressed(page, "[data-kind=hulls]"), "true");
  const switched = await poses(page);
  await fast(page, 120);
  const pushed = moved(switched, await poses(page)).filter((metres) => metres > 0.05).length;
  assert.ok(pushed >= 1, "hulls of rings that hang push each other away");
  await page.click("#restart");
  await page.until("state.steps === 0", PATIENCE);
  await fast(page, 400);
  await writeFile(join(pictures, `${name}-hulls.png`), await page.picture());

  for (const kind of ["parts", "triangles", "medial"]) {
    await page.click(`[data-kind=${kind}]`);
    await page.until(`state.kind === '${kind}'`, PATIENCE);
    const steps = await page.value("state.steps");
    assert.equal(await fast(page, 10), steps + 10);
  }
  await page.click("#collider");
  assert.ok((await drawn(page)) > 100, "colliders are drawn");
  await writeFile(join(pictures, `${name}-colliders.png`), await page.picture());
  assert.equal(await page.value("new Set(performance.getEntriesByType('resource').map((r) => new URL(r.name).origin)).size"), 1, "nothing comes from elsewhere");
  await page.click("#collider");
  const size = SIZES[name];
  const save = async (what) => writeFile(join(pictures, `${name}-${what}.png`), await page.picture());
  await sideBySide(page, save);
  await slowMotion(page);
  await throwing(page, size, save);
  await keys(page);
  await zooming(page, size);
  await ownMesh(page, save);
  assert.deepEqual(page.errors, [], "no error on the console");
  await page.close();
  console.log(`${name}: ${hung} rings hang, ${pushed} pushed away as hulls; compared, thrown, dropped, zoomed`);
}

try {
  await backends();
  await no_webgpu();
  for (const name of Object.keys(SIZES)) await at_size(name);
} finally {
  await browser.close();
  server.close();
}
