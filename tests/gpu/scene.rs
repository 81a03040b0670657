//! A device, meshes and motions for the tests.

use crate::ccd::motion::{Ball, Motion, Query, Rigid};
use crate::ccd::rng::Rng;
use nalgebra::Vector3;
use pollster::block_on;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::{MedialMesh, MedialPrimitive, MedialSphere};

/// Any adapter, be it code on the CPU.
pub fn options() -> GpuOptions {
    GpuOptions {
        software: true,
        ..GpuOptions::default()
    }
}

/// `None`, and says so, where there is no adapter and none is required.
pub fn gpu(options: GpuOptions) -> Option<Gpu> {
    match block_on(Gpu::open(options)) {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            let required = std::env::var("MEDIAL_REQUIRE_GPU").is_ok_and(|v| v != "0");
            assert!(!required, "MEDIAL_REQUIRE_GPU is set, but: {error}");
            println!("SKIP: {error}");
            None
        }
    }
}

fn vector(rng: &mut Rng) -> Vector {
    Vector::from([0; 3].map(|_| rng.range(-1.0, 1.0) as Real))
}

/// A band of slabs, a chain of cones of that many links, and a lone sphere, about 1 across.
pub fn mesh(rng: &mut Rng, links: u32) -> MedialMesh {
    let mut spheres = Vec::new();
    for k in 0..=links {
        let angle = k as Real / links as Real * 6.0;
        let at = Vector::new(angle.cos(), 0.2 * angle, angle.sin()) * 0.5;
        let radius = rng.range(0.005, 0.03) as Real;
        spheres.push(MedialSphere::new(at + vector(rng) * 0.01, radius));
    }
    let band = (0..links / 2).map(|k| [k, k + 1, k + 2]).collect();
    let edges = (links / 2 + 1..links).map(|k| [k, k + 1]).collect();
    spheres.push(MedialSphere::new(vector(rng) * 0.1, 0.05));
    MedialMesh::new(spheres, edges, band).expect("a medial mesh")
}

/// A body at that distance that flies towards the origin with that speed and turns.
pub fn motion(rng: &mut Rng, distance: Real, speed: Real, spin: Real) -> NonlinearRigidMotion {
    let away = vector(rng).normalize_or_zero();
    let start = Pose::new(away * distance, vector(rng) * 3.0);
    let center = vector(rng) * 0.2;
    let velocity = (vector(rng) * 0.4 - away) * speed;
    NonlinearRigidMotion::new(start, center, velocity, vector(rng) * spin)
}

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z).map(f64::from)
}

fn rigid(m: &NonlinearRigidMotion) -> Rigid {
    let q = m.start.rotation;
    Rigid {
        translation: wide(m.start.translation),
        rotation: [q.x, q.y, q.z, q.w].map(f64::from),
        local_center: wide(m.local_center),
        linvel: wide(m.linvel),
        angvel: wide(m.angvel),
    }
}

/// Two primitives in rigid motion, for the oracle.
pub fn query(
    primitives: [&MedialPrimitive; 2],
    motions: [&NonlinearRigidMotion; 2],
    seconds: Real,
) -> Query {
    let balls = primitives.map(|p| {
        let ball = |s: &MedialSphere| Ball {
            center: wide(s.center),
            radius: s.radius.into(),
            displacement: Vector3::zeros(),
        };
        p.spheres().iter().map(ball).collect()
    });
    Query {
        balls,
        motion: Motion::Rigid(Box::new(motions.map(rigid)), seconds.into()),
    }
}
