// Lower bounds of the distance that hold for all interpolation parameters at once, on straight
// paths: twin of src/elementary/certificate.rs, where the derivation is. Any direction is sound;
// only the corners are checked, and a corner that cannot be shown positive gives no time.

struct ActiveFace { e1: vec3<f32>, e2: vec3<f32>, rate1: vec3<f32>, rate2: vec3<f32>, d1: f32, d2: f32 }

fn active_face(triangle: bool, f: Family, s: Nearest, u_rate: vec3<f32>, v_rate: vec3<f32>) -> ActiveFace {
  let free_a = 0.0 < s.alpha && s.alpha < 1.0;
  let free_b = 0.0 < s.beta && s.beta < 1.0;
  let third = triangle && free_a && free_b && 1.0 - 8.0 * EPSILON < s.alpha + s.beta;
  var face = ActiveFace(vec3<f32>(), vec3<f32>(), vec3<f32>(), vec3<f32>(), 0.0, 0.0);
  if (third) {
    face.e1 = f.v - f.u; face.rate1 = v_rate - u_rate; face.d1 = f.db - f.da;
    return face;
  }
  if (free_a) { face.e1 = f.u; face.rate1 = u_rate; face.d1 = f.da; }
  if (free_b) { face.e2 = f.v; face.rate2 = v_rate; face.d2 = f.db; }
  return face;
}

fn lower_bound(triangle: bool, f: Family, n: vec3<f32>) -> f32 {
  let du = dot(n, f.u) - f.da;
  let dv = dot(n, f.v) - f.db;
  let base = dot(n, f.w) - f.r0;
  if (triangle) { return base + min(min(du, dv), 0.0); }
  return base + min(du, 0.0) + min(dv, 0.0);
}

fn face_direction(face: ActiveFace, triangle: bool, f: Family, s: Nearest) -> vec3<f32> {
  let rough = s.y / max(s.length, TINY);
  let g11 = length_sq(face.e1);
  let g22 = length_sq(face.e2);
  let g12 = dot(face.e1, face.e2);
  let r1 = dot(rough, face.e1) - face.d1;
  let r2 = dot(rough, face.e2) - face.d2;
  let determinant = max(g11 * g22 - g12 * g12, PARALLEL_ULPS * EPSILON * g11 * g22);
  let both = TINY < determinant;
  let safe = select(1.0, determinant, both);
  let k1 = select(r1 / max(g11, TINY), (r1 * g22 - r2 * g12) / safe, both);
  let k2 = select(r2 / max(g22, TINY), (r2 * g11 - r1 * g12) / safe, both);
  let moved = rough - face.e1 * k1 - face.e2 * k2;
  let refined = moved / max(length(moved), TINY);
  return select(rough, refined, lower_bound(triangle, f, rough) < lower_bound(triangle, f, refined));
}

fn regular(g: f32) -> f32 { return select(g * (1.0 + TURNING_REGULARISATION), 1.0, g <= TINY); }

fn turning_rate(face: ActiveFace, s: Nearest, n: vec3<f32>, y_rate: vec3<f32>) -> vec3<f32> {
  let n1 = dot(n, face.e1);
  let n2 = dot(n, face.e2);
  let along = dot(n, y_rate);
  let a11 = regular(length_sq(face.e1) - n1 * n1);
  let a22 = regular(length_sq(face.e2) - n2 * n2);
  let a12 = dot(face.e1, face.e2) - n1 * n2;
  let b1 = -(s.length * dot(face.rate1, n) + dot(face.e1, y_rate) - n1 * along);
  let b2 = -(s.length * dot(face.rate2, n) + dot(face.e2, y_rate) - n2 * along);
  let determinant = max(a11 * a22 - a12 * a12, a11 * a22 * TURNING_REGULARISATION);
  let moved = y_rate + face.e1 * ((b1 * a22 - b2 * a12) / determinant) + face.e2 * ((b2 * a11 - b1 * a12) / determinant);
  return (moved - n * dot(n, moved)) / max(s.length, TINY);
}

// First τ > 0 with a0 + a1 τ + a2 τ² = 0, for a0 > 0.
fn first_root(a0: f32, a1: f32, a2: f32) -> f32 {
  let discriminant = a1 * a1 - 4.0 * a2 * a0;
  let denominator = sqrt(max(discriminant, 0.0)) - a1;
  let exists = 0.0 <= discriminant && TINY < denominator;
  return select(NEVER, 2.0 * a0 / select(1.0, denominator, exists), exists);
}
