// A batch of elementary tests on straight paths, one thread each: twin of
// src/elementary/bracket.rs. Source: paper §4.2–4.3 for the two half steps.
//
// It proposes: `separated` is proven, with a slack for the rounding of any conforming device;
// everything else goes back to the CPU, with a time before which there is no contact. Unlike the
// twin it does not close the bracket from above, which is the CPU's, but stops where a sphere pair
// shows that there is nothing to prove; nor does it use the Lipschitz step, whose distance is not
// shown by corners.

@group(0) @binding(0) var<uniform> params: ElementaryParams;
@group(0) @binding(1) var<storage, read> queries: array<Query>;
@group(0) @binding(2) var<storage, read_write> bounds: array<Bound>;

// How far each of the two kinds of proof reaches, as a fraction of the step.
struct Steps { fixed: f32, turning: f32 }

fn corner(query: Query, k: u32, t: f32) -> vec3<f32> { return query.start[k].xyz + query.rate[k].xyz * t; }

// Largest |y| at both ends plus the largest radius sum: size of the numbers in play.
fn scale(query: Query) -> f32 {
  var sq = 0.0;
  var radius = 0.0;
  for (var k = 0u; k < 4u; k++) {
    sq = max(sq, max(length_sq(corner(query, k, 0.0)), length_sq(corner(query, k, 1.0))));
    radius = max(radius, abs(query.start[k].w));
  }
  return sqrt(sq) + radius;
}

// Whether the sphere pair that is nearest now meets later: then there is nothing to prove.
fn meets(y: vec3<f32>, rate: vec3<f32>, radius: f32, left: f32) -> bool {
  let t = clamp(-dot(y, rate) / max(length_sq(rate), TINY), 0.0, left);
  return length_sq(y + rate * t) < radius * radius && radius > 0.0;
}

// Fixed direction n and one that turns with rate m, at one corner of the family. What is not shown
// positive counts as contact, a NaN too.
fn corner_steps(steps: Steps, query: Query, k: u32, t: f32, n: vec3<f32>, m: vec3<f32>, slack: f32) -> Steps {
  let y = corner(query, k, t);
  let radius = query.start[k].w;
  let rate = query.rate[k].xyz;
  let a0 = dot(n, y) - radius - slack;
  let a1 = dot(n, rate);
  let root = first_root(a0, a1 + dot(m, y), dot(m, rate) - 0.5 * length_sq(m) * max(radius, 0.0));
  let fixed_step = min(steps.fixed, select(a0 / -a1, NEVER, a1 >= 0.0));
  let apart = a0 > 0.0;
  return Steps(select(0.0, fixed_step, apart), select(0.0, min(steps.turning, root), apart));
}

// A slab's family is a triangle: its fourth corner is the third once more.
fn bracket(query: Query, triangle: bool) -> Bound {
  let slack = scale(query) * (GPU_SLACK_ULPS * EPSILON);
  let tolerance = max(params.tolerance, slack * TOLERANCE_PER_SLACK);
  let r0 = query.rate[0].xyz;
  let u_rate = query.rate[1].xyz - r0;
  let v_rate = query.rate[2].xyz - r0;
  let radius = query.start[0].w;
  let da = query.start[1].w - radius;
  let db = query.start[2].w - radius;
  var lower = 0.0;
  for (var i = 0u; i < params.max_iterations; i++) {
    let y0 = corner(query, 0u, lower);
    let f = Family(y0, corner(query, 1u, lower) - y0, corner(query, 2u, lower) - y0, radius, da, db);
    var s: Nearest;
    if (triangle) { s = nearest_in_triangle(f); } else { s = nearest_in_box(f); }
    if (s.distance <= tolerance) { return Bound(lower, UNSETTLED, i + 1u, 0u); }
    let y_rate = r0 + u_rate * s.alpha + v_rate * s.beta;
    let face = active_face(triangle, f, s, u_rate, v_rate);
    let n = face_direction(face, triangle, f, s);
    // Any turning rate is sound; one whose square would overflow is not worth having.
    let turning = turning_rate(face, s, n, y_rate);
    let m = select(vec3<f32>(), turning, all(abs(turning) < vec3<f32>(1.0e15)));
    var steps = Steps(NEVER, min(NEVER, 1.0 / max(length(m), TINY)));
    for (var k = 0u; k < 4u; k++) { steps = corner_steps(steps, query, k, lower, n, m, slack); }
    let proven = (lower + max(steps.fixed, steps.turning)) * (1.0 - 2.0 * STEP_ULPS * EPSILON);
    if (!(proven > lower)) { return Bound(lower, UNSETTLED, i + 1u, 0u); }
    if (proven >= 1.0) { return Bound(1.0, SEPARATED, i + 1u, 0u); }
    if (meets(s.y, y_rate, s.length - s.distance, 1.0 - lower)) { return Bound(proven, UNSETTLED, i + 1u, 0u); }
    lower = proven;
  }
  return Bound(lower, UNSETTLED, params.max_iterations, 0u);
}

// Cone with cone.
@compute @workgroup_size(64)
fn cones(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * 64u;
  if (q < params.count) { bounds[q] = bracket(queries[q], false); }
}

// Sphere with slab. An entry point of its own, so that no device computes both.
@compute @workgroup_size(64)
fn slabs(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * 64u;
  if (q < params.count) { bounds[q] = bracket(queries[q], true); }
}
