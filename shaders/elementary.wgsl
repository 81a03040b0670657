// A batch of elementary tests on straight paths, one thread each: twin of
// src/elementary/bracket.rs. Source: paper §4.2–4.3 for the two half steps.
//
// It proposes: what it calls free is proven, with a slack for the rounding of any conforming device;
// everything else goes back to the CPU, with a time before which there is no contact. Unlike the
// twin it does not close the bracket from above, which is the CPU's, but stops where a sphere pair
// shows that there is nothing to prove; nor does it use the Lipschitz step, whose distance is not
// shown by corners. A cone pair's fourth corner follows from the others; the slack covers its rounding.

@group(0) @binding(0) var<uniform> params: ElementaryParams;
@group(0) @binding(1) var<storage, read> queries: array<Query>;
// Times before which there is no contact; 1: none in the whole step.
@group(0) @binding(2) var<storage, read_write> lowers: array<f32>;

// How far each of the two kinds of proof reaches, as a fraction of the step.
struct Steps { fixed: f32, turning: f32 }

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

// Whether the sphere pair that is nearest now meets later: then there is nothing to prove.
fn meets(y: vec3<f32>, rate: vec3<f32>, radius: f32, left: f32) -> bool {
  let t = clamp(-dot(y, rate) / max(length_sq(rate), TINY), 0.0, left);
  return length_sq(y + rate * t) < radius * radius && radius > 0.0;
}

// A direction, the rate with which it turns, and the slack.
struct Turning { n: vec3<f32>, m: vec3<f32>, slack: f32 }

// Fixed direction and turning one at one corner of the family. What is not shown positive counts as
// contact, a NaN too.
fn corner_steps(steps: Steps, y: vec3<f32>, rate: vec3<f32>, radius: f32, by: Turning) -> Steps {
  let a0 = dot(by.n, y) - radius - by.slack;
  let a1 = dot(by.n, rate);
  let root = first_root(a0, a1 + dot(by.m, y), dot(by.m, rate) - 0.5 * length_sq(by.m) * max(radius, 0.0));
  let fixed_step = min(steps.fixed, select(a0 / -a1, NEVER, a1 >= 0.0));
  let apart = a0 > 0.0;
  return Steps(select(0.0, fixed_step, apart), select(0.0, min(steps.turning, root), apart));
}

fn free_until(query: Query, triangle: bool) -> f32 {
  let s0 = query.start[0];
  let s1 = query.start[1] - s0;
  let s2 = query.start[2] - s0;
  let r0 = query.rate[0];
  let motion = Motion(Family(s0.xyz, s1.xyz, s2.xyz, s0.w, s1.w, s2.w), r0, query.rate[1] - r0, query.rate[2] - r0);
  let far = max(abs(s0.w), max(abs(query.start[1].w), abs(query.start[2].w))) + max(size(triangle, motion.start), size(triangle, family(motion, 1.0)));
  let slack = far * (GPU_SLACK_ULPS * EPSILON);
  let tolerance = max(params.tolerance, slack * TOLERANCE_PER_SLACK);
  var lower = 0.0;
  for (var i = 0u; i < params.max_iterations; i++) {
    let f = family(motion, lower);
    var s: Nearest;
    if (triangle) { s = nearest_in_triangle(f); } else { s = nearest_in_box(f); }
    if (s.distance <= tolerance) { return lower; }
    let y_rate = motion.w + motion.u * s.alpha + motion.v * s.beta;
    let face = active_face(triangle, f, s, motion.u, motion.v);
    let n = face_direction(face, triangle, f, s);
    // Any turning rate is sound; one whose square would overflow is not worth having.
    let rate = turning_rate(face, s, n, y_rate);
    let by = Turning(n, select(vec3<f32>(), rate, all(abs(rate) < vec3<f32>(1.0e15))), slack);
    var steps = Steps(NEVER, min(NEVER, 1.0 / max(length(by.m), TINY)));
    steps = corner_steps(steps, f.w, motion.w, f.r0, by);
    steps = corner_steps(steps, f.w + f.u, motion.w + motion.u, f.r0 + f.da, by);
    steps = corner_steps(steps, f.w + f.v, motion.w + motion.v, f.r0 + f.db, by);
    if (!triangle) {
      steps = corner_steps(steps, f.w + f.u + f.v, motion.w + motion.u + motion.v, f.r0 + f.da + f.db, by);
    }
    let proven = (lower + max(steps.fixed, steps.turning)) * (1.0 - 2.0 * STEP_ULPS * EPSILON);
    if (!(proven > lower)) { return lower; }
    if (proven >= 1.0) { return 1.0; }
    let left = 1.0 - lower;
    lower = proven;
    if (meets(s.y, y_rate, s.length - s.distance, left)) { return lower; }
  }
  return lower;
}

// Cone with cone.
@compute @workgroup_size(THREADS)
fn cones(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * THREADS;
  if (q < params.count) { lowers[q] = free_until(queries[q], false); }
}

// Sphere with slab. An entry point of its own, so that no device computes both.
@compute @workgroup_size(THREADS)
fn slabs(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * THREADS;
  if (q < params.count) { lowers[q] = free_until(queries[q], true); }
}
