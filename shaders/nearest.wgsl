// The member of a linearly interpolated family of sphere pairs that is nearest: twin of
// src/math/nearest.rs, where the derivation is. Source: paper §4.2, Eqs. (1) and (2) at fixed t.

struct Family { w: vec3<f32>, u: vec3<f32>, v: vec3<f32>, r0: f32, da: f32, db: f32 }
struct Nearest { alpha: f32, beta: f32, distance: f32, y: vec3<f32>, length: f32 }

fn length_sq(v: vec3<f32>) -> f32 { return dot(v, v); }

fn family_at(f: Family, alpha: f32, beta: f32) -> Nearest {
  let y = f.w + f.u * alpha + f.v * beta;
  let size = length(y);
  return Nearest(alpha, beta, size - (f.r0 + f.da * alpha + f.db * beta), y, size);
}

// Minimiser over x in [0, 1] of |y + x e| − d x.
fn edge_minimum(y: vec3<f32>, e: vec3<f32>, d: f32) -> f32 {
  let ee = length_sq(e);
  let discriminant = ee - d * d;
  let contained = discriminant <= ee * (2.0 * EPSILON);
  let q = length_sq(cross(y, e));
  let x = (d * sqrt(q / select(discriminant, 1.0, contained)) - dot(y, e)) / select(ee, 1.0, contained);
  return select(clamp(x, 0.0, 1.0), select(0.0, 1.0, d > 0.0), contained);
}

// Interior stationary point, not clamped; z says whether it exists.
fn interior_stationary(f: Family) -> vec3<f32> {
  let n = cross(f.u, f.v);
  let nn = length_sq(n);
  let independent = length_sq(f.u) * length_sq(f.v) * (64.0 * EPSILON * EPSILON) + TINY < nn;
  let safe_nn = select(1.0, nn, independent);
  let u_dual = cross(f.v, n);
  let v_dual = cross(n, f.u);
  let g = (u_dual * f.da + v_dual * f.db) / safe_nn;
  let hh = 1.0 - length_sq(g);
  let real = EPSILON < hh;
  let z = g * (abs(dot(f.w, n)) / sqrt(safe_nn * select(1.0, hh, real))) - f.w;
  return vec3<f32>(dot(u_dual, z) / safe_nn, dot(v_dual, z) / safe_nn, select(0.0, 1.0, independent && real));
}

fn nearer(a: Nearest, b: Nearest) -> Nearest {
  if (b.distance < a.distance) { return b; }
  return a;
}

// Minimum over the unit box: interior and 4 edges.
fn nearest_in_box(f: Family) -> Nearest {
  var best = family_at(f, edge_minimum(f.w, f.u, f.da), 0.0);
  best = nearer(best, family_at(f, edge_minimum(f.w + f.v, f.u, f.da), 1.0));
  best = nearer(best, family_at(f, 0.0, edge_minimum(f.w, f.v, f.db)));
  best = nearer(best, family_at(f, 1.0, edge_minimum(f.w + f.u, f.v, f.db)));
  let s = interior_stationary(f);
  if (s.z == 0.0) { return best; }
  return nearer(best, family_at(f, clamp(s.x, 0.0, 1.0), clamp(s.y, 0.0, 1.0)));
}

// Minimum over the triangle α, β ≥ 0, α + β ≤ 1: interior and 3 edges.
fn nearest_in_triangle(f: Family) -> Nearest {
  var best = family_at(f, edge_minimum(f.w, f.u, f.da), 0.0);
  best = nearer(best, family_at(f, 0.0, edge_minimum(f.w, f.v, f.db)));
  let x = edge_minimum(f.w + f.u, f.v - f.u, f.db - f.da);
  best = nearer(best, family_at(f, 1.0 - x, x));
  let s = interior_stationary(f);
  if (s.z == 0.0 || s.x < 0.0 || s.y < 0.0 || s.x + s.y > 1.0) { return best; }
  return nearer(best, family_at(f, s.x, s.y));
}
