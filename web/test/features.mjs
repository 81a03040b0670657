// What the user can do on the page besides switching colliders: compare, throw, slow down, fold, drop a mesh, keys, fingers.
import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { TRIANGLES, frameGlb, frameObj } from "./meshes.mjs";

export const PATIENCE = 240;

export const poses = (page) => page.value("Array.from(state.poses)");
export const places = (poses) =>
  Array.from({ length: poses.length / 7 }, (_, body) => poses.slice(7 * body, 7 * body + 3));
export const moved = (a, b) => places(a).map((place, k) => Math.hypot(...place.map((x, i) => x - places(b)[k][i])));
export async function fast(page, steps) {
  const before = await page.value(`(() => { const button = document.getElementById("step"); for (let k = 0; k < ${steps}; k += 1) button.click(); return state.steps; })()`);
  await page.until(`state.steps >= ${before + steps}`, PATIENCE);
  return page.value("state.steps");
}
export const pressed = (page, selector) => page.value(`document.querySelector("${selector}").getAttribute("aria-pressed")`);
const text = (page, id) => page.value(`document.getElementById("${id}").textContent`);
const isSeen = (page, id) => page.value(`document.getElementById("${id}").getClientRects().length > 0`);

// Two worlds from the same start, each with its name over it.
export async function sideBySide(page, save) {
  await fast(page, 5);
  await page.click("#split");
  await page.until("state.split && state.steps === 0", PATIENCE);
  assert.deepEqual(await page.value("Array.from(state.beside)"), await poses(page), "both begin alike");
  assert.deepEqual([await text(page, "name-left"), await text(page, "name-right")], ["medial meshes", "convex hulls"]);
  await fast(page, 330);
  const apart = moved(await poses(page), await page.value("Array.from(state.beside)"));
  assert.ok(apart.filter((metres) => metres > 0.3).length >= 5, `worlds go apart: ${apart}`);
  await save("split");
  await page.click("#split");
  await page.until("!state.split", PATIENCE);
  assert.ok(!(await isSeen(page, "name-left")));
}

// Clicks throw bodies along the ray under the pointer, at most forty; drags turn and throw none.
export async function throwing(page, { width, height, mobile }, save) {
  await page.until("!state.split", PATIENCE);
  await page.click("#restart");
  await page.until("state.steps === 0", PATIENCE);
  const count = (await poses(page)).length / 7;
  assert.equal(count, 16, "a restart takes away what was thrown");
  const [low, high] = mobile ? [0.2, 0.8] : [0.4, 0.9];
  const y = 0.3 * height;
  await page.clickAt(low * width, y);
  await page.clickAt(high * width, y);
  await page.until(`state.poses.length === ${7 * 18}`, PATIENCE);
  const before = await poses(page);
  await fast(page, 12);
  const after = await poses(page);
  const turn = await page.value("state.turn");
  // Along the picture's own axis to the right.
  const right = ([x, , z]) => x * Math.cos(turn) - z * Math.sin(turn);
  const [left, other] = [16, 17].map((body) => right(places(after)[body]) - right(places(before)[body]));
  assert.ok(left < -0.2 && other > 0.2, `thrown to the left and to the right: ${left}, ${other}`);
  const far = moved(before, after).slice(16);
  // 16 m/s for 12 steps is 3.2 m.
  assert.ok(far.every((metres) => Math.abs(metres - 3.2) < 0.5), `thrown at 16 m/s: ${far}`);
  await save("thrown");
  await page.drag([0.7 * width, y], [0.8 * width, y + 20]);
  await page.until(`state.turn !== ${turn}`, PATIENCE);
  assert.equal((await poses(page)).length, 7 * 18, "a drag throws nothing");
  await page.click("#throw");
  await page.until(`state.poses.length === ${7 * 19}`, PATIENCE);
  await page.value("for (let k = 0; k < 60; k += 1) document.getElementById('throw').click()");
  await page.until(`state.poses.length === ${7 * (16 + 40)}`, PATIENCE);
  await fast(page, 5);
  assert.equal((await poses(page)).length, 7 * (16 + 40), "no more than forty");
  assert.ok((await poses(page)).every(Number.isFinite));
  await page.click("#restart");
  await page.until(`state.poses.length === ${7 * 16}`, PATIENCE);
}

// In slow motion a sixth as many steps are made at most: ten in a second.
export async function slowMotion(page) {
  await page.click("#slow");
  await page.until("state.slow", PATIENCE);
  if (await page.value("state.paused")) await page.click("#pause");
  await page.until("!state.paused", PATIENCE);
  const [steps, seconds] = await page.value(`new Promise((resolve) => {
    const [from, start] = [state.steps, performance.now()];
    const look = () => performance.now() - start > 3000
      ? resolve([state.steps - from, (performance.now() - start) / 1000]) : requestAnimationFrame(look);
    look();
  })`);
  assert.ok(steps > 0 && steps <= 10 * seconds + 4, `${steps} steps in ${seconds} s of slow motion`);
  await page.click("#slow");
  await page.click("#pause");
  await page.until("!state.slow && state.paused", PATIENCE);
}

export async function folding(page, mobile) {
  const folded = () => page.value("document.getElementById('fold').getAttribute('aria-expanded') === 'false'");
  assert.equal(await folded(), mobile, "on a phone the panel begins folded");
  const share = () => page.value("document.getElementById('panel').getBoundingClientRect().height / innerHeight");
  const before = await share();
  await page.click("#fold");
  assert.equal(await folded(), !mobile);
  assert.equal(await isSeen(page, "kinds"), mobile);
  const after = await share();
  const [open, shut] = mobile ? [after, before] : [before, after];
  assert.ok(shut < 0.35 && open > shut + 0.2, `panel folded ${shut} of the page, unfolded ${open}`);
  if (!mobile) await page.click("#fold");
}

// Each key does what its button does.
export async function keys(page) {
  await page.value("document.getElementById('view').focus()");
  if (!(await page.value("state.paused"))) await page.key(" ");
  await page.until("state.paused", PATIENCE);
  await page.key("r");
  await page.until("state.steps === 0", PATIENCE);
  await page.key(".");
  await page.until("state.steps === 1", PATIENCE);
  await page.key("4");
  await page.until("state.kind === 'triangles'", PATIENCE);
  await page.key("c");
  await page.until("state.split", PATIENCE);
  assert.deepEqual([await text(page, "name-left"), await text(page, "name-right")], ["triangles", "convex hulls"]);
  await page.key("2");
  await page.until("state.kind === 'hulls'", PATIENCE);
  await page.until("document.getElementById('name-right').textContent === 'medial meshes'", PATIENCE);
  await page.key("c");
  await page.key("1");
  await page.until("!state.split && state.kind === 'medial'", PATIENCE);
  await page.key("d");
  await page.until("document.getElementById('collider').checked", PATIENCE);
  await page.key("d");
  await page.key("l");
  await page.until("state.slow", PATIENCE);
  await page.key("l");
  await page.key("t");
  await page.until(`state.poses.length === ${7 * 17}`, PATIENCE);
  const [turn, distance] = await page.value("[state.turn, state.distance]");
  await page.key("ArrowRight");
  await page.key("+");
  await page.until(`state.turn > ${turn} && state.distance < ${distance}`, PATIENCE);
  await page.key("ArrowLeft");
  await page.key("-");
  await page.until(`Math.abs(state.turn - ${turn}) < 1e-6 && Math.abs(state.distance - ${distance}) < 1e-6`, PATIENCE);
  await page.key(" ");
  await page.until("!state.paused", PATIENCE);
}

export async function zooming(page, { width, height, mobile }) {
  const [x, y] = [0.6 * width, 0.3 * height];
  const distance = await page.value("state.distance");
  if (mobile) await page.touch([[x - 30, y], [x + 30, y]], [[x - 45, y], [x + 45, y]], [[x - 60, y], [x + 60, y]]);
  else await page.wheel(x, y, -700);
  const nearer = mobile ? [0.4, 0.6] : [0.45, 0.55];
  await page.until(`state.distance < ${nearer[1] * distance}`, PATIENCE);
  assert.ok((await page.value("state.distance")) > nearer[0] * distance, "fingers twice as far apart: half as far");
  if (mobile) await page.touch([[x - 60, y], [x + 60, y]], [[x - 30, y], [x + 30, y]]);
  else await page.wheel(x, y, 700);
  await page.until(`state.distance > ${0.9 * distance}`, PATIENCE);
}

// Bodies of the user's: dropped, chosen, refused, cancelled; then rings again.
export async function ownMesh(page, save) {
  const drop = (name, content) => page.value(`(() => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([${JSON.stringify(content)}], ${JSON.stringify(name)}));
    dispatchEvent(new DragEvent("dragenter", { dataTransfer, cancelable: true }));
    const asked = document.getElementById("drop").getClientRects().length > 0;
    dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
    return asked && document.getElementById("drop").hidden;
  })()`);
  const told = (words) => page.until(`document.getElementById("says").textContent.includes(${JSON.stringify(words)})`, PATIENCE);
  if (!(await page.value("state.paused"))) await page.click("#pause");
  await page.click("#restart");
  await page.until("state.paused && state.steps === 0", PATIENCE);
  await fast(page, 10);
  assert.ok(await drop("frame.obj", frameObj()), "a place to drop is shown");
  await page.until("!document.getElementById('building').hidden", PATIENCE);
  await told(`frame.obj: ${TRIANGLES.length} triangles`);
  assert.ok((await page.value("state.told")) > 3, "the worker tells how far it is");
  assert.equal(await pressed(page, "#own"), "true");
  await page.until("state.steps === 0", PATIENCE);
  assert.equal((await poses(page)).length, 7 * 16);
  await fast(page, 360);
  const end = await poses(page);
  assert.ok(end.every(Number.isFinite));
  assert.ok(places(end).every(([, y]) => y > -0.02), "none falls through the ground");
  await save("own");
  await page.click("#split");
  await page.until("state.split && state.steps === 0", PATIENCE);
  await fast(page, 200);
  assert.ok((await page.value("Array.from(state.beside)")).every(Number.isFinite));
  await page.click("#split");

  const file = join(await mkdtemp(join(tmpdir(), "medial-web-")), "frame.glb");
  await writeFile(file, frameGlb());
  await page.choose("#file", file);
  await told(`frame.glb: ${TRIANGLES.length} triangles`);

  await drop("notes.txt", "no mesh");
  await told("notes.txt: no mesh file");
  await drop("broken.obj", "v 0 0 0\nv 1 0\n");
  await told("broken.obj, line 2");
  await drop("again.obj", frameObj());
  await page.value("document.getElementById('cancel').click()");
  await told("again.obj: cancelled");
  assert.equal(await text(page, "own"), "frame.glb", "what was refused changes nothing");
  await page.click("#rings");
  await page.until("document.getElementById('rings').getAttribute('aria-pressed') === 'true'", PATIENCE);
  assert.equal(await text(page, "own"), "your mesh …");
  const steps = await page.value("state.steps");
  assert.equal(await fast(page, 10), steps + 10);
}
