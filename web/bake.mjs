// Builds the page's medial meshes with the page's own WebAssembly: node bake.mjs FOLDER.
import { readFile, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";

const folder = resolve(process.argv[2]);
// Node takes the module's JavaScript for a script unless it is told.
const source = await readFile(join(folder, "medial_web.js"));
const { default: init, bake } = await import(`data:text/javascript;base64,${source.toString("base64")}`);
await init({ module_or_path: await readFile(join(folder, "medial_web_bg.wasm")) });
for (const [name, primitives] of [["ring", 27], ["creature", 300]]) {
  await writeFile(join(folder, `${name}.medial`), bake(name, primitives));
}
