// What the JavaScript engines of the league share: the scenes, the clock, the file of a run.

import { readFileSync, writeFileSync } from "node:fs";

export const scenes = () => JSON.parse(readFileSync(process.argv[2], "utf8"));

/// One world's trajectory: `step` advances it, `state` gives 13 numbers for each body.
export function steps(world, step, state) {
  const [ms, frames] = [[], []];
  for (let number = 1; number <= world.steps; number += 1) {
    // Of the processor, not of the clock: other programs run beside.
    const start = process.cpuUsage();
    step();
    const { user, system } = process.cpuUsage(start);
    ms.push((user + system) / 1000);
    if (number % world.every === 0) frames.push(state().flat());
  }
  return { ms, frames };
}

export function write(engine, version, setting, worlds) {
  const name = `${engine} ${setting}`.replace(/\W/g, "_");
  const run = { engine, version, setting, is_wasm: true, worlds };
  writeFileSync(`${process.argv[3]}/${name}.json`, JSON.stringify(run));
  console.error(`${engine} ${version}, ${setting}`);
}

/// Middle, half the length, and the rotation (x, y, z, w) that takes `axis` to the way from one end to the other.
export function capsule([a, b, c, d, e, f, radius], axis) {
  const way = [d - a, e - b, f - c];
  const length = Math.hypot(...way);
  const [x, y, z] = way.map((v) => v / length);
  const [u, v, w] = axis;
  const cosine = u * x + v * y + w * z;
  const half = [v * z - w * y, w * x - u * z, u * y - v * x, 1 + cosine];
  const norm = Math.hypot(...half);
  // Opposite to the axis any rotation by half a turn across it will do.
  const turn = norm < 1e-6 ? [v, w, u, 0] : half.map((q) => q / norm);
  return { middle: [(a + d) / 2, (b + e) / 2, (c + f) / 2], half: length / 2, radius, turn };
}
