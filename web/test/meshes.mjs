// Files of a body for the tests: a square frame of 32 triangles, as OBJ and as GLB.

const [OUT, IN, HIGH] = [0.5, 0.3, 0.1];
const VERTICES = [-HIGH, HIGH].flatMap((z) =>
  [OUT, IN].flatMap((r) => [[-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z]]));
// Below outside 0–3, inside 4–7; above 8–11, 12–15.
const QUADS = [0, 1, 2, 3].flatMap((k) => {
  const next = (k + 1) % 4;
  return [[k, next, next + 8, k + 8], [next + 4, k + 4, k + 12, next + 12], [k + 8, next + 8, next + 12, k + 12], [next, k, k + 4, next + 4]];
});
export const TRIANGLES = QUADS.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);

export function frameObj() {
  const lines = [...VERTICES.map((v) => `v ${v.join(" ")}`), ...QUADS.map((q) => `f ${q.map((i) => i + 1).join(" ")}`)];
  return lines.join("\n") + "\n";
}

export function frameGlb() {
  const points = new Float32Array(VERTICES.flat());
  const corners = new Uint16Array(TRIANGLES.flat());
  const binary = Buffer.concat([Buffer.from(points.buffer), Buffer.from(corners.buffer)]);
  const scene = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    buffers: [{ byteLength: binary.length }],
    bufferViews: [{ buffer: 0, byteLength: points.byteLength }, { buffer: 0, byteOffset: points.byteLength, byteLength: corners.byteLength }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: VERTICES.length, type: "VEC3", min: [-OUT, -OUT, -HIGH], max: [OUT, OUT, HIGH] },
      { bufferView: 1, componentType: 5123, count: corners.length, type: "SCALAR" },
    ],
  };
  const text = JSON.stringify(scene);
  const json = Buffer.from(text.padEnd(4 * Math.ceil(text.length / 4)));
  const chunk = (type, data) => {
    const head = Buffer.alloc(8);
    head.writeUInt32LE(data.length, 0);
    head.writeUInt32LE(type, 4);
    return Buffer.concat([head, data]);
  };
  const body = Buffer.concat([chunk(0x4e4f534a, json), chunk(0x004e4942, binary)]);
  const head = Buffer.alloc(12);
  head.writeUInt32LE(0x46546c67, 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}
