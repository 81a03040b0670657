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
  let uu = length_sq(f.u);
  let uv = dot(f.u, f.v);
  let uw = dot(f.u, f.w);
  let safe_uu = max(uu, TINY);
  let k = uv / safe_uu;
  let v = f.v - f.u * k;
  let w = f.w - f.u * (uw / safe_uu);
  let vv = length_sq(v);
  let independent = uu > TINY && length_sq(f.v) * (64.0 * EPSILON * EPSILON) + TINY < vv;
  let safe_vv = select(1.0, vv, independent);
  let d = f.db - f.da * k;
  let hh = 1.0 - f.da * f.da / safe_uu - d * d / safe_vv;
  let real = EPSILON < hh;
  let wv = dot(w, v);
  let s = length(w - v * (wv / safe_vv)) / sqrt(select(1.0, hh, real));
  let beta = (s * d - wv) / safe_vv;
  let alpha = (s * f.da - uw - beta * uv) / safe_uu;
  return vec3<f32>(alpha, beta, select(0.0, 1.0, independent && real));
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
