//! Bodies of four kinds in as many primitives as asked for: what detail costs is told by the same body, finer.

use rapier3d::math::{Real, Vector};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::f32::consts::TAU;

/// A kind of body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A closed tube of cones.
    Ring,
    /// A round plate of slabs with eight long, thin legs of cones.
    Spider,
    /// A thick, bent sheet of slabs with four stout legs of cones.
    Bear,
    /// A flat sheet of slabs of radius 0.
    Sheet,
}

/// Spheres and primitives that are added to.
#[derive(Default)]
struct Parts {
    spheres: Vec<MedialSphere>,
    cones: Vec<[u32; 2]>,
    slabs: Vec<[u32; 3]>,
}

impl Parts {
    fn sphere(&mut self, center: Vector, radius: Real) -> u32 {
        self.spheres.push(MedialSphere::new(center, radius));
        self.spheres.len() as u32 - 1
    }

    /// A square sheet of about so many slabs on `[-1, 1]²`, placed and made thick by `at`.
    fn sheet(&mut self, slabs: usize, at: impl Fn(Real, Real) -> (Vector, Real)) -> u32 {
        let n = ((slabs as Real / 2.0).sqrt().round() as u32).max(1);
        let first = self.spheres.len() as u32;
        let place = |i: u32| 2.0 * i as Real / n as Real - 1.0;
        for i in 0..=n {
            for j in 0..=n {
                let (center, radius) = at(place(i), place(j));
                self.sphere(center, radius);
            }
        }
        let vertex = |i: u32, j: u32| first + i * (n + 1) + j;
        for i in 0..n {
            for j in 0..n {
                let [a, b] = [vertex(i, j), vertex(i + 1, j)];
                let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
                self.slabs.extend([[a, b, c], [a, c, d]]);
            }
        }
        vertex(n / 2, n / 2)
    }

    /// A chain of cones from a sphere along a path over `(0, 1]`.
    fn limb(&mut self, from: u32, cones: usize, at: impl Fn(Real) -> (Vector, Real)) {
        let mut last = from;
        for k in 1..=cones {
            let (center, radius) = at(k as Real / cones as Real);
            let next = self.sphere(center, radius);
            self.cones.push([last, next]);
            last = next;
        }
    }
}

/// A body of about 1 m in about so many primitives.
pub fn detailed(form: Form, primitives: usize) -> MedialMesh {
    let mut parts = Parts::default();
    match form {
        Form::Ring => {
            let n = primitives as u32;
            for k in 0..n {
                let (sin, cos) = (TAU * k as Real / n as Real).sin_cos();
                parts.sphere(Vector::new(cos, 0.0, sin) * 0.5, 0.12);
                parts.cones.push([k, (k + 1) % n]);
            }
        }
        Form::Spider => {
            let plate = |x: Real, z: Real| (Vector::new(0.15 * x, 0.05 * x * z, 0.15 * z), 0.08);
            let middle = parts.sheet(primitives / 5, plate);
            let each = (primitives - parts.slabs.len()) / 8;
            for leg in 0..8 {
                let (sin, cos) = (TAU * (leg as Real + 0.5) / 8.0).sin_cos();
                let out = Vector::new(cos, 0.0, sin);
                parts.limb(middle, each, |s| {
                    let rise = 0.35 * (TAU * 0.45 * s).sin() - 0.25 * s * s;
                    (out * (0.1 + 0.55 * s) + Vector::Y * rise, 0.035 - 0.02 * s)
                });
            }
        }
        Form::Bear => {
            let back = |x: Real, z: Real| {
                let bend = -0.12 * x * x - 0.05 * z * z;
                let radius = 0.2 - 0.08 * x.abs().max(z.abs());
                (Vector::new(0.2 * x, bend, 0.35 * z), radius)
            };
            let middle = parts.sheet(primitives * 3 / 5, back);
            let each = (primitives - parts.slabs.len()) / 4;
            for [x, z] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                parts.limb(middle, each, |s| {
                    let reach = s.min(0.5) * 2.0;
                    let drop = -0.1 * reach - 0.5 * (s - 0.3).max(0.0);
                    (
                        Vector::new(0.2 * x * reach, drop, 0.35 * z * reach),
                        0.12 - 0.04 * s,
                    )
                });
            }
        }
        Form::Sheet => {
            parts.sheet(primitives, |x, z| (Vector::new(0.5 * x, 0.0, 0.5 * z), 0.0));
        }
    }
    MedialMesh::new(parts.spheres, parts.cones, parts.slabs).expect("a medial mesh")
}
