// A batch of elementary tests on straight paths, one thread each. Source: the fixed direction of
// src/elementary/certificate.rs, and its derivation; the direction is that of the nearest sphere pair,
// paper §4.2, Eqs. (1) and (2).
//
// It proposes: what it calls free is proven, with a slack for the rounding of any conforming device;
// everything else goes to the CPU. A direction proves a piece of the step. The first one is taken where
// the middles pass each other, because it mostly proves all; the next ones at an end of what is proven.
// It stops where a sphere pair meets: nothing is left to prove. A cone pair's fourth corner follows from
// the others; the slack covers its rounding.

@group(0) @binding(0) var<uniform> params: ElementaryParams;
@group(0) @binding(1) var queries: texture_2d<u32>;
// FREE or OPEN.
@group(0) @binding(2) var<storage, read_write> answers: array<u32>;

// Corner 0 and what leads from it to corners 1 and 2, with their displacements over the step.
struct Motion { start: Family, w: vec3<f32>, u: vec3<f32>, v: vec3<f32> }

fn family(m: Motion, t: f32) -> Family {
  let s = m.start;
  return Family(s.w + m.w * t, s.u + m.u * t, s.v + m.v * t, s.r0, s.da, s.db);
}

// Largest |y| of the corners.
fn size(triangle: bool, f: Family) -> f32 {
  var sq = max(length_sq(f.w), max(length_sq(f.w + f.u), length_sq(f.w + f.v)));
  if (!triangle) { sq = max(sq, length_sq(f.w + f.u + f.v)); }
  return sqrt(sq);
}

// Time from now until y is shortest.
fn closest(y: vec3<f32>, rate: vec3<f32>) -> f32 { return -dot(y, rate) / max(length_sq(rate), TINY); }

// A piece of the step.
struct Piece { begin: f32, end: f32 }

// Rest of the piece where a corner's bound is positive: it changes evenly from now to then. What is
// not shown positive counts as contact. The slack covers the rounding of a time near 1.
fn in_front(piece: Piece, n: vec3<f32>, y: vec3<f32>, rate: vec3<f32>, radius: f32) -> Piece {
  let now = dot(n, y) - radius;
  let change = dot(n, rate);
  let then = now + change;
  let reach = max(now, then) / max(abs(change), TINY) * (1.0 - 2.0 * STEP_ULPS * EPSILON);
  return Piece(
    max(piece.begin, select(1.0 - reach, 0.0, now > 0.0)),
    min(piece.end, select(reach, 1.0, then > 0.0)),
  );
}

fn stays_free(query: Query, triangle: bool) -> bool {
  let s0 = query.start[0];
  let s1 = query.start[1] - s0;
  let s2 = query.start[2] - s0;
  let r0 = query.rate[0];
  let f = Family(s0.xyz, s1.xyz, s2.xyz, s0.w, s1.w, s2.w);
  let m = Motion(f, r0, query.rate[1] - r0, query.rate[2] - r0);
  let far = max(abs(s0.w), max(abs(query.start[1].w), abs(query.start[2].w))) + max(size(triangle, f), size(triangle, family(m, 1.0)));
  let slack = far * (GPU_SLACK_ULPS * EPSILON) + sqrt(TINY);
  let middle = select(0.5, 1.0 / 3.0, triangle);
  var t = clamp(closest(f.w + (f.u + f.v) * middle, m.w + (m.u + m.v) * middle), 0.0, 1.0);
  var proven = Piece(t, t);
  for (var i = 0u; i < params.max_iterations; i++) {
    var s: Nearest;
    if (triangle) { s = nearest_in_triangle(family(m, t)); } else { s = nearest_in_box(family(m, t)); }
    if (!(s.distance > slack)) { return false; }
    let rate = m.w + m.u * s.alpha + m.v * s.beta;
    let radius = s.length - s.distance;
    let met = s.y + rate * (clamp(t + closest(s.y, rate), 0.0, 1.0) - t);
    if (length_sq(met) < radius * radius && radius > 0.0) { return false; }
    let n = s.y / max(s.length, sqrt(TINY));
    var piece = in_front(Piece(0.0, 1.0), n, f.w, m.w, f.r0 + slack);
    piece = in_front(piece, n, f.w + f.u, m.w + m.u, f.r0 + f.da + slack);
    piece = in_front(piece, n, f.w + f.v, m.w + m.v, f.r0 + f.db + slack);
    if (!triangle) {
      piece = in_front(piece, n, f.w + f.u + f.v, m.w + m.u + m.v, f.r0 + f.da + f.db + slack);
    }
    // It has to join what is proven, and to add to it.
    if (!(piece.begin <= t && t <= piece.end)) { return false; }
    if (piece.begin >= proven.begin && piece.end <= proven.end) { return false; }
    proven = Piece(min(proven.begin, piece.begin), max(proven.end, piece.end));
    if (proven.begin <= 0.0 && proven.end >= 1.0) { return true; }
    t = select(proven.begin, proven.end, proven.end < 1.0);
  }
  return false;
}

fn query(q: u32) -> Query { return Query(three(queries, q * QUERY), corners(q * QUERY + 3u)); }

fn corners(at: u32) -> array<vec3<f32>, 3> {
  let words = three(queries, at);
  return array<vec3<f32>, 3>(words[0].xyz, words[1].xyz, words[2].xyz);
}

// Cone with cone.
@compute @workgroup_size(THREADS)
fn cones(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * THREADS;
  if (q < params.count) { answers[q] = select(OPEN, FREE, stays_free(query(q), false)); }
}

// Sphere with slab. An entry point of its own, so that no device computes both.
@compute @workgroup_size(THREADS)
fn slabs(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * THREADS;
  if (q < params.count) { answers[q] = select(OPEN, FREE, stays_free(query(q), true)); }
}
