// Spheres and primitives swept over the step: chords of their centres with radii that cover the
// sagitta. Twin of src/pair/swept.rs; what it calls free is free on any conforming device, because
// the pair's slack is taken off every bound.

struct Swept { start: vec3<f32>, chord: vec3<f32>, radius: f32 }

fn place(m: array<vec4<f32>, 3>, p: vec3<f32>) -> vec3<f32> {
  return vec3<f32>(dot(m[0].xyz, p) + m[0].w, dot(m[1].xyz, p) + m[1].w, dot(m[2].xyz, p) + m[2].w);
}

// The lever arm is bounded by the distance from the centre of rotation.
fn sweep(side: Side, sphere: vec4<f32>) -> Swept {
  let start = place(side.start, sphere.xyz);
  let end = place(side.end, sphere.xyz);
  return Swept(start, end - start, sphere.w + side.turn.w * distance(sphere.xyz, side.turn.xyz));
}

// Whether two swept spheres come within reach.
fn meet(a: Swept, b: Swept, reach: f32) -> bool {
  let y = b.start - a.start;
  let rate = b.chord - a.chord;
  // An inexact time of closest approach costs less than the slack: the distance is flat there.
  let t = clamp(-dot(y, rate) / max(dot(rate, rate), TINY), 0.0, 1.0);
  return !(length(y + rate * t) > a.radius + b.radius + reach);
}

struct Simplex { spheres: array<Swept, 3>, count: u32 }

fn simplex(side: Side, primitive: u32) -> Simplex {
  var s: Simplex;
  s.count = primitives[primitive].count;
  for (var k = 0u; k < 3u; k++) { s.spheres[k] = sweep(side, primitives[primitive].spheres[k]); }
  return s;
}

fn at(s: Swept, t: f32) -> vec3<f32> { return s.start + s.chord * t; }

// Gap of two primitives along a unit direction: a lower bound of their distance.
fn gap(a: ptr<function, Simplex>, b: ptr<function, Simplex>, n: vec3<f32>, t: f32) -> f32 {
  var far = -HUGE;
  var near = HUGE;
  for (var k = 0u; k < (*a).count; k++) { far = max(far, dot(n, at((*a).spheres[k], t)) + (*a).spheres[k].radius); }
  for (var k = 0u; k < (*b).count; k++) { near = min(near, dot(n, at((*b).spheres[k], t)) - (*b).spheres[k].radius); }
  return near - far;
}

// A direction along which two primitives are apart at time t, as far as Gilbert's iteration finds
// one: the point of their difference nearest to the origin, from chords of it. Only the quality of
// a proof depends on it.
fn direction(a: ptr<function, Simplex>, b: ptr<function, Simplex>, t: f32) -> vec3<f32> {
  var y = at((*b).spheres[0], t) - at((*a).spheres[0], t);
  var best = vec3<f32>();
  var widest = -HUGE;
  for (var round = 0u; round < GILBERT_ROUNDS; round++) {
    let n = y / max(length(y), TINY);
    var far = -HUGE;
    var near = HUGE;
    var s = vec3<f32>();
    var r = vec3<f32>();
    for (var k = 0u; k < (*a).count; k++) {
      let c = at((*a).spheres[k], t);
      let along = dot(n, c) + (*a).spheres[k].radius;
      if (along > far) { far = along; s = c + n * (*a).spheres[k].radius; }
    }
    for (var k = 0u; k < (*b).count; k++) {
      let c = at((*b).spheres[k], t);
      let along = dot(n, c) - (*b).spheres[k].radius;
      if (along < near) { near = along; r = c - n * (*b).spheres[k].radius; }
    }
    if (near - far > widest) { widest = near - far; best = n; }
    let e = r - s - y;
    y = y + e * clamp(-dot(y, e) / max(dot(e, e), TINY), 0.0, 1.0);
  }
  return best;
}

// Time before which two primitives are proven to stay out of the pair's reach; 1: all the step. A
// fixed direction's gap is concave in time along chords, so it lies above its own chord.
fn free_until(pair: u32, i: u32, j: u32) -> f32 {
  var a = simplex(pairs[pair].sides[0], i);
  var b = simplex(pairs[pair].sides[1], j);
  let reach = pairs[pair].reach;
  var lower = 0.0;
  for (var round = 0u; round < PROOF_ROUNDS; round++) {
    let n = direction(&a, &b, lower);
    let now = gap(&a, &b, n, lower) - reach;
    if (!(now > 0.0)) { return lower; }
    let then = gap(&a, &b, n, 1.0) - reach;
    if (then > 0.0) { return 1.0; }
    let proven = (lower + (1.0 - lower) * (now / (now - then))) * (1.0 - 2.0 * STEP_ULPS * EPSILON);
    if (!(proven > lower)) { return lower; }
    lower = proven;
  }
  return lower;
}
