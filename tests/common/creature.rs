//! Two meshes of 1,236 primitives each (800 slabs, 436 cones) and the scenes they are asked about: of
//! the bench `mesh_pairs` and of the test that bounds its counts.

use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::{MedialMesh, MedialSphere};

/// Length of a step.
pub const SECONDS: Real = 1.0 / 60.0;

/// A curved sheet of 20 × 20 cells (800 slabs) with a rim of 12 spikes (436 cones in all).
pub fn creature() -> MedialMesh {
    let mut spheres = Vec::new();
    let mut faces = Vec::new();
    let n = 21;
    for i in 0..n {
        for j in 0..n {
            let (x, z) = (i as Real / 20.0 - 0.5, j as Real / 20.0 - 0.5);
            let y = 0.3 * (3.0 * x).cos() * (2.0 * z).cos();
            let radius = 0.03 + 0.05 * (0.5 - x.abs()).min(0.5 - z.abs());
            spheres.push(MedialSphere::new(Vector::new(x, y, z), radius));
        }
    }
    let at = |i: u32, j: u32| i * n as u32 + j;
    for i in 0..20 {
        for j in 0..20 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut edges = Vec::new();
    for spike in 0..12u32 {
        let angle = spike as Real / 12.0 * std::f32::consts::TAU;
        let out = Vector::new(angle.cos(), 0.4 * (2.0 * angle).sin(), angle.sin());
        let rim = |v: Real| ((v * 0.5 + 0.5) * 20.0).round() as u32;
        let mut last = at(rim(out.x), rim(out.z));
        let cones = if spike < 4 { 37 } else { 36 };
        for k in 1..=cones {
            let s = k as Real / cones as Real;
            let wave = Vector::new(0.0, 0.05 * (9.0 * s).sin(), 0.0);
            let base = spheres[at(rim(out.x), rim(out.z)) as usize].center;
            let next = spheres.len() as u32;
            spheres.push(MedialSphere::new(
                base + out * (0.6 * s) + wave,
                0.03 * (1.0 - s) + 0.004,
            ));
            edges.push([last, next]);
            last = next;
        }
    }
    MedialMesh::new(spheres, edges, faces).expect("a medial mesh")
}

fn comb(teeth: u32) -> MedialMesh {
    let mut spheres = Vec::new();
    let mut edges = Vec::new();
    for t in 0..teeth {
        let x = t as Real * 0.02;
        for k in 0..=20 {
            let v = spheres.len() as u32;
            spheres.push(MedialSphere::new(
                Vector::new(x, k as Real * 0.05, 0.0),
                0.004,
            ));
            if k > 0 {
                edges.push([v - 1, v]);
            } else if t > 0 {
                edges.push([v - 21, v]);
            }
        }
    }
    MedialMesh::new(spheres, edges, vec![]).expect("a medial mesh")
}

struct Random(u64);
impl Random {
    fn next(&mut self) -> Real {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 40) as Real / (1u64 << 24) as Real) * 2.0 - 1.0
    }
    fn vector(&mut self) -> Vector {
        Vector::new(self.next(), self.next(), self.next())
    }
}

pub fn motion(at: Vector, turn: Vector, velocity: Vector, spin: Vector) -> NonlinearRigidMotion {
    NonlinearRigidMotion::new(Pose::new(at, turn), Vector::ZERO, velocity, spin)
}

/// Two creatures this far apart (lengths), at this speed towards each other (per second), turning (at
/// most this per axis, radians per second).
pub struct Scene {
    pub name: &'static str,
    distance: Real,
    speed: Real,
    spin: Real,
}

const fn scene(name: &'static str, distance: Real, speed: Real, spin: Real) -> Scene {
    Scene {
        name,
        distance,
        speed,
        spin,
    }
}

pub const SCENES: [Scene; 5] = [
    scene("apart", 6.0, 5.0, 2.0),
    scene("approach", 1.9, 20.0, 5.0),
    scene("fast, 4 body sizes a step", 4.0, 300.0, 10.0),
    scene("overlapping at the start", 0.2, 5.0, 2.0),
    scene("close", 1.5, 2.0, 2.0),
];

/// Motions of both creatures in a scene, always the same.
pub fn motions(scene: &Scene, count: usize) -> Vec<[NonlinearRigidMotion; 2]> {
    let mut random = Random(11);
    let (distance, speed, spin) = (scene.distance, scene.speed, scene.spin);
    (0..count)
        .map(|_| {
            let away = random.vector().normalize_or_zero() * distance;
            let towards = -away.normalize_or_zero() * speed + random.vector() * (0.1 * speed);
            let m1 = motion(
                Vector::ZERO,
                random.vector(),
                Vector::ZERO,
                random.vector() * spin,
            );
            let m2 = motion(away, random.vector() * 3.0, towards, random.vector() * spin);
            [m1, m2]
        })
        .collect()
}

/// Two combs whose long teeth interleave, and slide, without touching.
pub fn combs() -> ([MedialMesh; 2], [NonlinearRigidMotion; 2]) {
    let m1 = motion(Vector::ZERO, Vector::ZERO, Vector::ZERO, Vector::ZERO);
    let m2 = motion(
        Vector::new(0.01, 1.2, 0.0),
        Vector::new(std::f32::consts::PI, 0.0, 0.0),
        Vector::new(0.0, -3.0, 0.0),
        Vector::ZERO,
    );
    ([comb(60), comb(60)], [m1, m2])
}
