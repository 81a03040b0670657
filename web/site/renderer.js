// Draws one scene, or two side by side, with WebGL 2: bodies on a ground, one light, its shadows cast straight onto the
// ground. Takes the pointer: drags turn, the wheel and two fingers zoom, clicks become rays into the scene.

const VERTEX = `#version 300 es
uniform mat4 view;
uniform vec4 rotation;
uniform vec3 place;
uniform bool shadow;
in vec3 position;
in vec3 normal;
out vec3 at;
out vec3 out_normal;
vec3 turned(vec3 v) { return v + 2.0 * cross(rotation.xyz, cross(rotation.xyz, v) + rotation.w * v); }
void main() {
  at = turned(position) + place;
  // Along the light of the other shader, onto a plane just above the ground.
  if (shadow) at = vec3(at.xz - at.y * vec2(0.56, 0.50), 0.004).xzy;
  out_normal = turned(normal);
  gl_Position = view * vec4(at, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 color;
uniform vec3 eye;
uniform int kind; // 0 body, 1 ground, 2 shadow
in vec3 at;
in vec3 out_normal;
out vec4 pixel;
void main() {
  if (kind == 2) { pixel = vec4(0.05, 0.07, 0.12, 0.33); return; }
  // Colliders may be open, or be seen from inside.
  vec3 n = normalize(gl_FrontFacing ? out_normal : -out_normal);
  vec3 to_sun = normalize(vec3(0.56, 1.0, 0.50));
  float sun = max(dot(n, to_sun), 0.0);
  vec3 light = vec3(0.34, 0.38, 0.44) * (0.75 + 0.25 * n.y) + vec3(0.72, 0.68, 0.60) * sun;
  vec3 base = color;
  if (kind == 1) {
    vec2 tile = floor(at.xz);
    base *= mod(tile.x + tile.y, 2.0) > 0.5 ? 0.92 : 1.0;
  } else {
    vec3 half_way = normalize(to_sun + normalize(eye - at));
    light += 0.25 * pow(max(dot(n, half_way), 0.0), 40.0);
  }
  float haze = kind == 1 ? smoothstep(6.0, 32.0, length(at.xz)) : 0.0;
  pixel = vec4(mix(pow(base * light, vec3(0.4545)), vec3(0.875, 0.902, 0.933), haze), 1.0);
}`;

// What the camera looks at (m), the tangent of half its opening angle, and its nearest and farthest place (m).
const TARGET = [0, 1.2, 0];
const SLOPE = Math.tan(0.36);
const DISTANCES = [3, 30];
// A pointer that moves less (pixels) in less time (ms) clicks.
const CLICK = { pixels: 6, milliseconds: 500 };

export class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, stencil: true });
    if (!gl) throw new Error("the browser has no WebGL 2");
    Object.assign(this, { canvas, gl, turn: 0.42, rise: 0.42, distance: 9, views: [], onClick: () => {} });
    this.program = link(gl);
    const names = ["view", "rotation", "place", "shadow", "color", "eye", "kind"];
    this.at = Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(this.program, name)]));
    this.ground = this.upload(
      [-60, 0, -60, -60, 0, 60, 60, 0, 60, 60, 0, -60],
      [0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0],
      [0, 1, 2, 0, 2, 3],
    );
    this.surfaces = [];
    this.listen();
  }

  // For each scene the surface of the creature, and that of all other bodies.
  setSurfaces(scenes) {
    const { gl } = this;
    for (const { array, buffers } of this.surfaces.flatMap((scene) => Object.values(scene))) {
      gl.deleteVertexArray(array);
      buffers.forEach((buffer) => gl.deleteBuffer(buffer));
    }
    const upload = (mesh) => {
      const uploaded = this.upload(mesh.vertices(), mesh.normals(), mesh.indices());
      mesh.free();
      return uploaded;
    };
    this.surfaces = scenes.map(({ falling, creature }) => ({ falling: upload(falling), creature: upload(creature) }));
  }

  upload(vertices, normals, indices) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = [["position", vertices], ["normal", normals]].map(([name, values]) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
      const location = gl.getAttribLocation(this.program, name);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
      return buffer;
    });
    buffers.push(gl.createBuffer());
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[2]);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(indices), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, buffers, length: indices.length };
  }

  // Draws scenes beside each other, or above each other where the page is narrow. `covered`: how much of the canvas
  // (CSS pixels, from the left and from the bottom) the panel covers. Gives back where each scene's middle and top are.
  draw(scenes, covered) {
    const { gl, canvas } = this;
    const scale = Math.min(window.devicePixelRatio, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const pixels = [width, height].map((side) => Math.round(side * scale));
    if (canvas.width !== pixels[0] || canvas.height !== pixels[1]) [canvas.width, canvas.height] = pixels;
    gl.clearColor(0.875, 0.902, 0.933, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.useProgram(this.program);
    this.views = this.layout(scenes.length, width, height, covered);
    this.views.forEach((view, k) => {
      const box = [view.x, height - view.y - view.height, view.width, view.height].map((side) => Math.round(side * scale));
      gl.viewport(...box);
      gl.scissor(...box);
      this.drawScene(scenes[k], this.surfaces[k], view);
    });
    gl.disable(gl.SCISSOR_TEST);
    // A line between them.
    if (scenes.length > 1) {
      gl.enable(gl.SCISSOR_TEST);
      const [, { x, y }] = this.views;
      const line = x > 0 ? [x - 1, 0, 2, height] : [0, height - y - 1, width, 2];
      gl.scissor(...line.map((side) => Math.round(side * scale)));
      gl.clearColor(1, 1, 1, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      gl.disable(gl.SCISSOR_TEST);
    }
    return this.views.map((view) => ({ x: view.free.x + view.free.width / 2, top: view.y }));
  }

  // Places of the scenes on the canvas (CSS pixels, from its upper left corner), with the part that the panel leaves free.
  layout(count, width, height, { left, bottom }) {
    const free = { x: left, y: 0, width: width - left, height: height - bottom };
    const stacked = free.width < free.height;
    const views = [];
    for (let k = 0; k < count; k += 1) {
      const [across, down] = stacked ? [1, count] : [count, 1];
      const part = { width: free.width / across, height: free.height / down };
      part.x = free.x + (stacked ? 0 : k * part.width);
      part.y = free.y + (stacked ? k * part.height : 0);
      // The first reaches under a panel on the left, the last under one below.
      const x = k === 0 || stacked ? 0 : part.x;
      const end = k === count - 1 || !stacked ? height : part.y + part.height;
      const view = { x, y: part.y, width: part.x + part.width - x, height: end - part.y, free: part };
      views.push({ ...view, camera: this.camera(view) });
    }
    return views;
  }

  drawScene(scene, surfaces, { camera: { matrix, eye } }) {
    const { gl, at } = this;
    gl.uniformMatrix4fv(at.view, false, matrix);
    gl.uniform3fv(at.eye, eye);

    gl.uniform1i(at.shadow, 0);
    gl.uniform1i(at.kind, 1);
    gl.uniform4f(at.rotation, 0, 0, 0, 1);
    gl.uniform3f(at.place, 0, 0, 0);
    gl.uniform3f(at.color, 0.66, 0.65, 0.63);
    this.drawSurface(this.ground);

    gl.uniform1i(at.kind, 0);
    this.drawBodies(scene, surfaces);
    // Each pixel of the ground is darkened once.
    gl.uniform1i(at.shadow, 1);
    gl.uniform1i(at.kind, 2);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    this.drawBodies(scene, surfaces);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.BLEND);
  }

  drawBodies({ poses, colors, creature }, surfaces) {
    const { gl, at } = this;
    for (let body = 0; 7 * body < poses.length; body += 1) {
      const pose = poses.subarray(7 * body, 7 * body + 7);
      gl.uniform3fv(at.place, pose.subarray(0, 3));
      gl.uniform4fv(at.rotation, pose.subarray(3, 7));
      gl.uniform3fv(at.color, colors.subarray(3 * body, 3 * body + 3));
      this.drawSurface(body === creature ? surfaces.creature : surfaces.falling);
    }
  }

  drawSurface({ array, length }) {
    const { gl } = this;
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, length, gl.UNSIGNED_INT, 0);
  }

  // Looks at the creature in the middle of a view's free part; from further off where that is narrow.
  camera({ x, y, width, height, free }) {
    const aspect = free.width / free.height;
    const distance = this.distance * Math.max(1, 0.95 / aspect);
    const back = [
      Math.cos(this.rise) * Math.sin(this.turn),
      Math.sin(this.rise),
      Math.cos(this.rise) * Math.cos(this.turn),
    ];
    const right = [Math.cos(this.turn), 0, -Math.sin(this.turn)];
    const up = cross(back, right);
    const eye = TARGET.map((x, k) => x + distance * back[k]);
    // From the view's middle to that of its free part, in half the view's sides.
    const shift = [
      (2 * (free.x + free.width / 2 - x)) / width - 1,
      1 - (2 * (free.y + free.height / 2 - y)) / height,
    ];
    const focal = [free.height / width / SLOPE, free.height / height / SLOPE];
    const [near, far] = [0.1, 200];
    const [sum, product] = [(near + far) / (near - far), (2 * near * far) / (near - far)];
    const shifted = (axis, k) => axis.map((x, i) => x * focal[k] - shift[k] * back[i]);
    const rows = [shifted(right, 0), shifted(up, 1), back.map((x) => x * sum), back.map((x) => -x)];
    const shifts = rows.map((row) => -dot(row, eye));
    shifts[2] += product;
    const matrix = [0, 1, 2].flatMap((column) => rows.map((row) => row[column]));
    return { matrix: new Float32Array([...matrix, ...shifts]), eye, axes: [right, up, back], shift, focal };
  }

  // From the eye through a place on the canvas (CSS pixels): where, along what, in the scene that is drawn there.
  ray(x, y) {
    const inside = (view) => x >= view.x && x < view.x + view.width && y >= view.y && y < view.y + view.height;
    const view = this.views.find(inside) ?? this.views[0];
    const { eye, axes: [right, up, back], shift, focal } = view.camera;
    const across = ((2 * (x - view.x)) / view.width - 1 - shift[0]) / focal[0];
    const above = (1 - (2 * (y - view.y)) / view.height - shift[1]) / focal[1];
    const along = back.map((b, i) => right[i] * across + up[i] * above - b);
    const from = eye.map((e, i) => e + along[i]);
    return { from: new Float32Array(from), along: new Float32Array(along) };
  }

  // The ray through the middle of the first scene.
  middleRay() {
    const { x, y, width, height } = this.views[0].free;
    return this.ray(x + width / 2, y + height / 2);
  }

  turnBy(turn, rise) {
    this.turn += turn;
    this.rise = Math.min(1.5, Math.max(0.05, this.rise + rise));
  }

  zoomBy(factor) {
    this.distance = Math.min(DISTANCES[1], Math.max(DISTANCES[0], this.distance * factor));
  }

  listen() {
    const { canvas } = this;
    // Fingers and buttons that are down: where they are, and where and when they came.
    const down = new Map();
    const spread = () => {
      const [a, b] = [...down.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      const { clientX: x, clientY: y, timeStamp: since } = event;
      down.set(event.pointerId, { x, y, start: [x, y], since, alone: down.size === 0 });
      if (down.size > 1) down.forEach((pointer) => (pointer.alone = false));
    });
    canvas.addEventListener("pointermove", (event) => {
      const pointer = down.get(event.pointerId);
      if (!pointer) return;
      const before = down.size === 2 ? spread() : 0;
      const moved = [event.clientX - pointer.x, event.clientY - pointer.y];
      [pointer.x, pointer.y] = [event.clientX, event.clientY];
      if (down.size === 1) this.turnBy(-0.006 * moved[0], 0.006 * moved[1]);
      if (down.size === 2 && spread() > 0) this.zoomBy(before / spread());
    });
    const lift = (event) => {
      const pointer = down.get(event.pointerId);
      down.delete(event.pointerId);
      if (!pointer || event.type !== "pointerup" || event.button !== 0 || !pointer.alone) return;
      const moved = Math.hypot(event.clientX - pointer.start[0], event.clientY - pointer.start[1]);
      if (moved < CLICK.pixels && event.timeStamp - pointer.since < CLICK.milliseconds) {
        this.onClick(this.ray(event.clientX, event.clientY));
      }
    };
    canvas.addEventListener("pointerup", lift);
    canvas.addEventListener("pointercancel", lift);
    canvas.addEventListener("wheel", (event) => {
      this.zoomBy(Math.exp(0.001 * event.deltaY));
      event.preventDefault();
    }, { passive: false });
  }
}

function link(gl) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
