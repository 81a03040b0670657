// Spheres and primitives swept over the step: chords of their centres with radii that cover the
// sagitta. sweep is the twin of Side::chord in src/pair/swept.rs; stays_free proves what free_until does in
// src/pair/apart.rs, along directions of Gilbert's iteration, which is here alone. What it calls free is
// free on any conforming device, because the pair's slack is taken off every bound.

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

// Unused spheres repeat the last.
struct Simplex { s0: Swept, s1: Swept, s2: Swept }

fn at(s: Swept, t: f32) -> vec3<f32> { return s.start + s.chord * t; }

// A point of a sphere, and how far it is along a direction.
struct Support { point: vec3<f32>, along: f32 }

// The farthest point of a sphere along a unit direction.
fn sphere_support(s: Swept, n: vec3<f32>, t: f32) -> Support {
  let c = at(s, t);
  return Support(c + n * s.radius, dot(n, c) + s.radius);
}

fn support(s: Simplex, n: vec3<f32>, t: f32) -> Support {
  let s0 = sphere_support(s.s0, n, t);
  let s1 = sphere_support(s.s1, n, t);
  let s2 = sphere_support(s.s2, n, t);
  var far = s0;
  if (s1.along > far.along) { far = s1; }
  if (s2.along > far.along) { far = s2; }
  return far;
}

// Gap of two primitives along a unit direction: a lower bound of their distance.
fn gap(a: Simplex, b: Simplex, n: vec3<f32>, t: f32) -> f32 {
  return -support(b, -n, t).along - support(a, n, t).along;
}

// A direction along which two primitives are apart at time t, as far as Gilbert's iteration finds
// one: the point of their difference nearest to the origin, from chords of it. Only the quality of
// a proof depends on it.
fn direction(a: Simplex, b: Simplex, t: f32) -> vec3<f32> {
  var y = at(b.s0, t) - at(a.s0, t);
  var best = vec3<f32>();
  var widest = -HUGE;
  for (var round = 0u; round < GILBERT_ROUNDS; round++) {
    // The square of a shorter y loses its digits, and n could be longer than 1.
    let n = y / max(length(y), sqrt(TINY));
    let s = support(a, n, t);
    let r = support(b, -n, t);
    let width = -r.along - s.along;
    if (width > widest) { widest = width; best = n; }
    let e = r.point - s.point - y;
    y = y + e * clamp(-dot(y, e) / max(dot(e, e), TINY), 0.0, 1.0);
  }
  return best;
}

// Whether two primitives are proven to stay out of the pair's reach, direction by direction: the first
// where they pass each other, because it mostly proves all, the next at an end of what is proven. A fixed
// direction's gap is concave in time along chords, so it lies above its own chords.
fn stays_free(a: Simplex, b: Simplex, reach: f32) -> bool {
  let rate = b.s0.chord - a.s0.chord;
  var t = clamp(-dot(b.s0.start - a.s0.start, rate) / max(dot(rate, rate), TINY), 0.0, 1.0);
  var begin = t;
  var end = t;
  for (var round = 0u; round < PROOF_ROUNDS; round++) {
    let n = direction(a, b, t);
    let now = gap(a, b, n, t) - reach;
    if (!(now > 0.0)) { return false; }
    let first = gap(a, b, n, 0.0) - reach;
    let last = gap(a, b, n, 1.0) - reach;
    let rounding = 2.0 * STEP_ULPS * EPSILON;
    begin = min(begin, select(t - t * (now / (now - first)) + rounding, 0.0, first > 0.0));
    end = max(end, select(t + (1.0 - t) * (now / (now - last)) - rounding, 1.0, last > 0.0));
    if (begin <= 0.0 && end >= 1.0) { return true; }
    let next = select(begin, end, end < 1.0);
    if (next == t) { return false; }
    t = next;
  }
  return false;
}
