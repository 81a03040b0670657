// Draws bodies on a ground with WebGL 2: one light, its shadows cast straight onto the ground.

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
  vec3 n = normalize(out_normal);
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

export class Renderer {
  constructor(canvas, count, colors) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, stencil: true });
    if (!gl) throw new Error("the browser has no WebGL 2");
    Object.assign(this, { canvas, gl, count, colors, turn: 0.42, rise: 0.42, distance: 9 });
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

  // The first body's surface serves all but the last.
  setSurfaces(surface) {
    const { gl } = this;
    for (const { array, buffers } of this.surfaces) {
      gl.deleteVertexArray(array);
      buffers.forEach((buffer) => gl.deleteBuffer(buffer));
    }
    this.surfaces = [0, this.count - 1].map((body) => {
      const mesh = surface(body);
      const uploaded = this.upload(mesh.vertices(), mesh.normals(), mesh.indices());
      mesh.free();
      return uploaded;
    });
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

  draw(poses) {
    const { gl, canvas, at } = this;
    const scale = Math.min(window.devicePixelRatio, 2);
    const [width, height] = [canvas.clientWidth * scale, canvas.clientHeight * scale].map(Math.round);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.875, 0.902, 0.933, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    const { matrix, eye } = this.camera(width / height);
    gl.uniformMatrix4fv(at.view, false, matrix);
    gl.uniform3fv(at.eye, eye);

    gl.uniform1i(at.shadow, 0);
    gl.uniform1i(at.kind, 1);
    gl.uniform4f(at.rotation, 0, 0, 0, 1);
    gl.uniform3f(at.place, 0, 0, 0);
    gl.uniform3f(at.color, 0.66, 0.65, 0.63);
    this.drawSurface(this.ground);

    gl.uniform1i(at.kind, 0);
    this.drawBodies(poses);
    // Each pixel of the ground is darkened once.
    gl.uniform1i(at.shadow, 1);
    gl.uniform1i(at.kind, 2);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    this.drawBodies(poses);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.BLEND);
  }

  drawBodies(poses) {
    const { gl, at, colors } = this;
    for (let body = 0; body < this.count; body += 1) {
      const pose = poses.subarray(7 * body, 7 * body + 7);
      gl.uniform3fv(at.place, pose.subarray(0, 3));
      gl.uniform4fv(at.rotation, pose.subarray(3, 7));
      gl.uniform3fv(at.color, colors.subarray(3 * body, 3 * body + 3));
      this.drawSurface(this.surfaces[body === this.count - 1 ? 1 : 0]);
    }
  }

  drawSurface({ array, length }) {
    const { gl } = this;
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, length, gl.UNSIGNED_INT, 0);
  }

  // Looks at the creature; on a narrow screen from further off, and the creature is in its upper part.
  camera(aspect) {
    const narrow = Math.max(1, 0.95 / aspect);
    const focal = 1 / Math.tan(0.36);
    const distance = this.distance * narrow;
    const target = [0, aspect < 1 ? -0.9 : 1.2, 0];
    const back = [
      Math.cos(this.rise) * Math.sin(this.turn),
      Math.sin(this.rise),
      Math.cos(this.rise) * Math.cos(this.turn),
    ];
    const right = [Math.cos(this.turn), 0, -Math.sin(this.turn)];
    const up = cross(back, right);
    const eye = target.map((x, k) => x + distance * back[k]);
    const [near, far] = [0.1, 200];
    const [sum, product] = [(near + far) / (near - far), (2 * near * far) / (near - far)];
    const rows = [right.map((x) => (x * focal) / aspect), up.map((x) => x * focal), back.map((x) => x * sum), back.map((x) => -x)];
    const shifts = rows.map((row) => -dot(row, eye));
    shifts[2] += product;
    const matrix = [0, 1, 2].flatMap((column) => rows.map((row) => row[column]));
    return { matrix: new Float32Array([...matrix, ...shifts]), eye };
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (!canvas.hasPointerCapture(event.pointerId)) return;
      this.turn -= 0.006 * event.movementX;
      this.rise = Math.min(1.5, Math.max(0.05, this.rise + 0.006 * event.movementY));
    });
    canvas.addEventListener("wheel", (event) => {
      this.distance = Math.min(30, Math.max(3, this.distance * Math.exp(0.001 * event.deltaY)));
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
