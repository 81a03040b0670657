// A batch of elementary tests on straight paths, one thread each: twin of
// src/elementary/bracket.rs. Source: paper §4.2–4.3 for the two half steps.
//
// It proposes: `separated` is proven, with a slack for the rounding of any conforming device;
// everything else goes back to the CPU, with a time before which there is no contact. Unlike the
// twin it neither closes the bracket from above, which is the CPU's, nor uses the Lipschitz step,
// whose distance is not shown by corners.

@group(0) @binding(0) var<uniform> params: ElementaryParams;
@group(0) @binding(1) var<storage, read> queries: array<Query>;
@group(0) @binding(2) var<storage, read_write> bounds: array<Bound>;

fn corner(q: u32, k: u32, t: f32) -> vec3<f32> {
  return queries[q].start[k].xyz + queries[q].rate[k].xyz * t;
}

// Largest |y| at both ends plus the largest radius sum: size of the numbers in play.
fn scale(q: u32) -> f32 {
  var sq = 0.0;
  var radius = 0.0;
  for (var k = 0u; k < 4u; k++) {
    sq = max(sq, max(length_sq(corner(q, k, 0.0)), length_sq(corner(q, k, 1.0))));
    radius = max(radius, abs(queries[q].start[k].w));
  }
  return sqrt(sq) + radius;
}

fn bracket(q: u32) -> Bound {
  let triangle = params.triangle != 0u;
  let count = select(4u, 3u, triangle);
  let slack = scale(q) * (GPU_SLACK_ULPS * EPSILON);
  let tolerance = max(params.tolerance, slack * TOLERANCE_PER_SLACK);
  var lower = 0.0;
  for (var i = 0u; i < params.max_iterations; i++) {
    let y0 = corner(q, 0u, lower);
    let f = Family(y0, corner(q, 1u, lower) - y0, corner(q, 2u, lower) - y0,
      queries[q].start[0].w, queries[q].start[1].w - queries[q].start[0].w, queries[q].start[2].w - queries[q].start[0].w);
    var s: Nearest;
    if (triangle) { s = nearest_in_triangle(f); } else { s = nearest_in_box(f); }
    if (s.distance <= tolerance) { return Bound(lower, UNSETTLED, i + 1u, 0u); }
    let r0 = queries[q].rate[0].xyz;
    let u_rate = queries[q].rate[1].xyz - r0;
    let v_rate = queries[q].rate[2].xyz - r0;
    let y_rate = r0 + u_rate * s.alpha + v_rate * s.beta;
    let face = active_face(triangle, f, s, u_rate, v_rate);
    let n = face_direction(face, triangle, f, s);
    // Any turning rate is sound; one whose square would overflow is not worth having.
    let turning = turning_rate(face, s, n, y_rate);
    let m = select(vec3<f32>(), turning, all(abs(turning) < vec3<f32>(1.0e15)));
    let mm = length_sq(m);
    // Fixed and turning direction, over all corners.
    var fixed_step = NEVER;
    var turning_step = min(NEVER, 1.0 / max(sqrt(mm), TINY));
    for (var k = 0u; k < count; k++) {
      let y = corner(q, k, lower);
      let radius = queries[q].start[k].w;
      let rate = queries[q].rate[k].xyz;
      let a0 = dot(n, y) - radius - slack;
      let a1 = dot(n, rate);
      // Written so that whatever is not shown positive counts as contact, a NaN too.
      if (!(a0 > 0.0)) { fixed_step = 0.0; turning_step = 0.0; break; }
      if (!(a1 >= 0.0)) { fixed_step = min(fixed_step, a0 / -a1); }
      turning_step = min(turning_step, first_root(a0, a1 + dot(m, y), dot(m, rate) - 0.5 * mm * max(radius, 0.0)));
    }
    let proven = (lower + max(fixed_step, turning_step)) * (1.0 - 2.0 * STEP_ULPS * EPSILON);
    if (!(proven > lower)) { return Bound(lower, UNSETTLED, i + 1u, 0u); }
    lower = proven;
    if (lower >= 1.0) { return Bound(1.0, SEPARATED, i + 1u, 0u); }
  }
  return Bound(lower, UNSETTLED, params.max_iterations, 0u);
}

@compute @workgroup_size(64)
fn elementary(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let q = id.x + id.y * groups.x * 64u;
  if (q >= params.count) { return; }
  bounds[q] = bracket(q);
}
