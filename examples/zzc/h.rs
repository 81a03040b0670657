#![allow(warnings)]
pub use rapier3d::prelude::*;
pub use rapier3d_medial::prelude::*;
pub use rapier3d::prelude::{Pose, Vector, SharedShape, Rotation};
pub use std::time::Instant;
pub struct Rng(pub u64);
impl Rng { pub fn new(s: u64) -> Self { let mut r = Rng(s.wrapping_mul(0x9E3779B97F4A7C15) | 1); for _ in 0..8 { r.u(); } r }
 pub fn u(&mut self) -> u64 { self.0 ^= self.0 << 13; self.0 ^= self.0 >> 7; self.0 ^= self.0 << 17; self.0.wrapping_mul(0x2545F4914F6CDD1D) }
 pub fn f(&mut self) -> f32 { (self.u() >> 40) as f32 / (1u64 << 24) as f32 }
 pub fn r(&mut self, a: f32, b: f32) -> f32 { a + (b - a) * self.f() }
 pub fn n(&mut self, n: usize) -> usize { ((self.u() >> 33) as usize) % n }
 pub fn p<T: Copy>(&mut self, a: &[T]) -> T { a[self.n(a.len())] }
 pub fn dir(&mut self) -> Vector { loop { let v = Vector::new(self.r(-1., 1.), self.r(-1., 1.), self.r(-1., 1.)); let l = v.length(); if l > 0.1 && l < 1.0 { return v / l; } } } }
#[derive(Clone)] pub struct Part { pub pose: Pose, pub mesh: MedialMesh, pub own: SharedShape }
pub fn cub(p: Vector, h: Vector) -> Part { Part { pose: Pose::from_translation(p), mesh: MedialMesh::cuboid(h).unwrap(), own: SharedShape::cuboid(h.x, h.y, h.z) } }
pub fn cubv(h: Vector) -> Vec<Part> { vec![cub(Vector::ZERO, h)] }
pub fn v3(x: f32, y: f32, z: f32) -> Vector { Vector::new(x, y, z) }
pub fn cap(a: Vector, b: Vector, r: f32) -> Part { Part { pose: Pose::IDENTITY, mesh: MedialMesh::capsule(a, b, r).unwrap(), own: SharedShape::capsule(a, b, r) } }
pub fn ball(p: Vector, r: f32) -> Part { Part { pose: Pose::from_translation(p), mesh: MedialMesh::ball(r).unwrap(), own: SharedShape::ball(r) } }
/// own compound beside built mesh of a polygon prism (polygon in xy ccw, made of boxes)
pub fn prism(poly: &[(f32, f32)], boxes: &[(f32, f32, f32, f32)], hz: f32, k: f32) -> Part {
  // triangulate via boxes is non manifold; use ear clipping
  let n = poly.len(); let mut v = vec![]; for z in [-hz, hz] { for p in poly { v.push(v3(p.0 * k, p.1 * k, z * k)); } }
  let mut idx: Vec<usize> = (0..n).collect(); let mut t: Vec<[u32; 3]> = vec![];
  let cr = |a: usize, b: usize, c: usize| { let (a, b, c) = (poly[a], poly[b], poly[c]); (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0) };
  while idx.len() > 2 { let m = idx.len(); let mut ok = false; for i in 0..m { let (a, b, c) = (idx[(i + m - 1) % m], idx[i], idx[(i + 1) % m]); if cr(a, b, c) <= 1e-9 { continue; }
    if idx.iter().any(|&p| p != a && p != b && p != c && cr(a, b, p) >= 0.0 && cr(b, c, p) >= 0.0 && cr(c, a, p) >= 0.0) { continue; }
    t.push([(a + n) as u32, (b + n) as u32, (c + n) as u32]); t.push([a as u32, c as u32, b as u32]); idx.remove(i); ok = true; break; } assert!(ok); }
  for i in 0..n { let j = (i + 1) % n; let (a, b, c, d) = (i as u32, j as u32, (i + n) as u32, (j + n) as u32); t.push([a, b, d]); t.push([a, d, c]); }
  let (mesh, _) = MedialMesh::from_trimesh(&v, &t, &BuildOptions { primitives: Some(100), ..Default::default() }).unwrap();
  let own = SharedShape::compound(boxes.iter().map(|b| (Pose::translation((b.0 + b.2) * 0.5 * k, (b.1 + b.3) * 0.5 * k, 0.0), SharedShape::cuboid((b.2 - b.0) * 0.5 * k, (b.3 - b.1) * 0.5 * k, hz * k))).collect());
  Part { pose: Pose::IDENTITY, mesh, own } }
pub fn l_prism() -> Part { prism(&[(-0.2, -0.2), (0.2, -0.2), (0.2, -0.1), (-0.1, -0.1), (-0.1, 0.2), (-0.2, 0.2)], &[(-0.2, -0.2, 0.2, -0.1), (-0.2, -0.1, -0.1, 0.2)], 0.1, 1.0) }
pub fn u_prism() -> Part { prism(&[(-0.2, -0.2), (0.2, -0.2), (0.2, 0.1), (0.1, 0.1), (0.1, -0.1), (-0.1, -0.1), (-0.1, 0.1), (-0.2, 0.1)], &[(-0.2, -0.2, 0.2, -0.1), (-0.2, -0.1, -0.1, 0.1), (0.1, -0.1, 0.2, 0.1)], 0.1, 1.0) }
pub fn t_prism() -> Part { prism(&[(-0.05, -0.2), (0.05, -0.2), (0.05, 0.1), (0.2, 0.1), (0.2, 0.2), (-0.2, 0.2), (-0.2, 0.1), (-0.05, 0.1)], &[(-0.05, -0.2, 0.05, 0.1), (-0.2, 0.1, 0.2, 0.2)], 0.1, 1.0) }
pub fn scaled(p: &Part, k: f32) -> Part { let own = match p.own.as_compound() { Some(c) => SharedShape::compound(c.shapes().iter().map(|(q, s)| { let c = s.as_cuboid().unwrap().half_extents * k; (Pose::from_translation(q.translation * k), SharedShape::cuboid(c.x, c.y, c.z)) }).collect()), None => { let c = p.own.as_cuboid().unwrap().half_extents * k; SharedShape::cuboid(c.x, c.y, c.z) } };
  Part { pose: Pose::from_translation(p.pose.translation * k), mesh: p.mesh.scaled(Vector::splat(k)).unwrap(), own } }
pub fn hulled(s: &SharedShape) -> SharedShape { if let Some(c) = s.as_compound() { return SharedShape::compound(c.shapes().iter().map(|(p, s)| (*p, hulled(s))).collect()); } if let Some(c) = s.as_cuboid() { let (p, _) = c.to_trimesh(); return SharedShape::convex_hull(&p).unwrap(); } s.clone() }
pub const MED: u8 = 0; pub const OWN: u8 = 1; pub const FINE: u8 = 2;
/// Builder of a scene of one kind.
pub struct B { pub w: PhysicsWorld, pub p: MedialPipeline, pub kind: u8, pub sub: usize, pub parts: Vec<(ColliderHandle, SharedShape)>, pub dynb: Vec<RigidBodyHandle>, pub bodyn: usize, pub drive: Option<Box<dyn FnMut(&mut PhysicsWorld, f32)>>, pub t: f32, pub pen: bool }
impl B {
  pub fn new(kind: u8, dt: f32, unit: f32, fine: usize) -> B { let mut w = PhysicsWorld::new(); w.gravity = v3(0., -9.81 * unit, 0.); let sub = if kind == FINE { fine } else { 1 }; w.integration_parameters.dt = dt / sub as f32; w.integration_parameters.length_unit = unit;
    B { w, p: MedialPipeline::new(MedialOptions::default()), kind, sub, parts: vec![], dynb: vec![], bodyn: 0, drive: None, t: 0.0, pen: true } }
  /// med: shapes of this body are medial in kind MED
  pub fn add(&mut self, bb: RigidBodyBuilder, parts: &[Part], med: bool, mu: f32, e: f32, mass: f32) -> RigidBodyHandle {
    let bb = bb.ccd_enabled(self.kind != MED); let b = self.w.bodies.insert(bb); let n = parts.len();
    let vol: f32 = parts.iter().map(|p| p.own.mass_properties(1.0).mass()).sum();
    for q in parts { let own = q.own.mass_properties(mass / vol); let c = if self.kind == MED && med { ColliderBuilder::medial_mesh(q.mesh.clone()) } else { ColliderBuilder::new(if self.kind == OWN && med && std::env::var("HULL").is_ok() { hulled(&q.own) } else { q.own.clone() }) };
      let h = self.w.insert_collider(c.position(q.pose).friction(mu).restitution(e).mass_properties(own), Some(b)); self.parts.push((h, q.own.clone())); }
    if self.w.bodies[b].is_dynamic() { self.dynb.push(b); } b }
  pub fn fixed(&mut self, s: SharedShape, at: Vector, mu: f32, e: f32) -> RigidBodyHandle { let b = self.w.bodies.insert(RigidBodyBuilder::fixed().translation(at)); let h = self.w.insert_collider(ColliderBuilder::new(s.clone()).friction(mu).restitution(e), Some(b)); self.parts.push((h, s)); b }
  pub fn energy(&self) -> f32 { self.dynb.iter().map(|b| { let b = &self.w.bodies[*b]; b.kinetic_energy() - b.mass() * self.w.gravity.dot(b.center_of_mass()) }).sum() }
  pub fn step(&mut self) -> StepReport { let mut r = StepReport::default(); for _ in 0..self.sub { if let Some(d) = &mut self.drive { d(&mut self.w, self.t); } if self.kind == MED { r = self.p.step(&mut self.w); } else { self.w.step(); } self.t += self.w.integration_parameters.dt; } r }
  pub fn deepest(&self) -> (f32, f32) { // overlap of own shapes of different bodies
    let mut d = 0.0f32; let n = self.parts.len(); for i in 0..n { for j in i + 1..n { let (a, b) = (&self.w.colliders[self.parts[i].0], &self.w.colliders[self.parts[j].0]); if a.parent() == b.parent() { continue; }
      let dynb = |c: &Collider| c.parent().map_or(false, |p| self.w.bodies[p].is_dynamic()); if !dynb(a) && !dynb(b) { continue; }
      let (x, y) = (self.parts[i].1.compute_aabb(a.position()), self.parts[j].1.compute_aabb(b.position())); if !rapier3d::parry::bounding_volume::BoundingVolume::intersects(&x, &y) { continue; }
      if let Ok(Some(c)) = rapier3d::parry::query::contact(a.position(), &*self.parts[i].1, b.position(), &*self.parts[j].1, 0.0) { d = d.max(-c.dist); } } } (d, 0.0) }
}
#[derive(Clone, Default)] pub struct Out { pub nan: bool, pub e0: f32, pub emax: f32, pub vup: f32, pub vmax: f32, pub deep: f32, pub deep_end: f32, pub end: Vec<(Vector, Vector, Rotation)>, pub mean: f64, pub worst: f64, pub asleep: usize, pub events: u32, pub vlast: f32 }
pub fn run(b: &mut B, steps: usize, trace: bool) -> Out { let mut o = Out::default(); o.e0 = b.energy(); o.emax = o.e0;
  for k in 0..steps { let t = Instant::now(); let r = b.step(); let s = t.elapsed().as_secs_f64() * 1e3; o.mean += s / steps as f64; o.worst = o.worst.max(s);
    o.emax = o.emax.max(b.energy()); let mut vm = 0.0f32; for h in &b.dynb { let q = &b.w.bodies[*h]; if !q.translation().is_finite() || !q.linvel().is_finite() || !q.is_enabled() { o.nan = true; } o.vup = o.vup.max(q.linvel().y); o.vmax = o.vmax.max(q.linvel().length()); vm = vm.max(q.linvel().length()); } if k * 5 >= steps * 4 { o.vlast = o.vlast.max(vm); }
    if b.pen { o.deep = o.deep.max(b.deepest().0); }
    if trace { println!("{k} E {:.4} deep {:.5} ev {} cq {} {:.2}ms", b.energy(), b.deepest().0, r.events, r.continuous_queries, s); for h in &b.dynb { let q = &b.w.bodies[*h]; println!("    {:.4?} v {:.3?} w {:.2?}{}", q.translation().to_array(), q.linvel().to_array(), q.angvel().to_array(), if q.is_sleeping() { " z" } else { "" }); } } }
  o.deep_end = b.deepest().0; o.asleep = b.dynb.iter().filter(|h| b.w.bodies[**h].is_sleeping()).count(); o.end = b.dynb.iter().map(|h| { let q = &b.w.bodies[*h]; (q.translation(), q.linvel(), *q.rotation()) }).collect(); o }
