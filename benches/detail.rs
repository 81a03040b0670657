//! What detail costs a step: sixty bodies of four kinds in 50, 200 and 500 primitives each, dropped into a pen.
//!
//! ```text
//! cargo bench --bench detail                    # minutes
//! cargo bench --bench detail -- --form Ring     # one kind
//! cargo bench --bench detail -- --form Ring --primitives 200
//! ```
//!
//! The counts take turns, three times; a step counts with the least of its three times. The last column is a
//! hash of where the bodies end.

mod common;
#[path = "../tests/common/detailed.rs"]
mod detailed;

use common::{Hash, median, processor};
use detailed::{Form, detailed};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::time::Instant;

const BODIES: usize = 60;
const STEPS: usize = 120;
const TURNS: usize = 3;
const PRIMITIVES: [usize; 3] = [50, 200, 500];
const FORMS: [Form; 4] = [Form::Ring, Form::Spider, Form::Bear, Form::Sheet];
/// Half the width of the pen, and the distance of the bodies that are dropped, lengths.
const PEN: Real = 2.4;
const APART: Real = 1.5;

fn world(mesh: &MedialMesh) -> PhysicsWorld {
    let mut world = PhysicsWorld::default();
    let ground = ColliderBuilder::cuboid(50.0, 0.5, 50.0).translation(Vector::NEG_Y * 0.5);
    world.insert_collider(ground, None);
    for out in [Vector::X, Vector::NEG_X, Vector::Z, Vector::NEG_Z] {
        let half = Vector::splat(50.0) - out.abs() * 49.5;
        let wall = ColliderBuilder::cuboid(half.x, half.y, half.z);
        world.insert_collider(wall.translation(out * (PEN + 0.5)), None);
    }
    for k in 0..BODIES {
        let at = |i: usize| (i as Real - 1.0) * APART;
        let center = Vector::new(at(k % 3), 1.0 + APART * (k / 9) as Real, at(k / 3 % 3));
        let tilt = Vector::new(0.7 * k as Real, 0.3, 0.2 * k as Real);
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(center, tilt));
        world.insert(body, ColliderBuilder::medial_mesh(mesh.clone()));
    }
    world
}

/// Milliseconds of each step, and a hash of where the bodies end.
fn run(mesh: &MedialMesh) -> (Vec<f64>, String) {
    let mut world = world(mesh);
    let mut pipeline = MedialPipeline::default();
    let step = |_| {
        let start = Instant::now();
        pipeline.step(&mut world);
        1e3 * start.elapsed().as_secs_f64()
    };
    let steps = (0..STEPS).map(step).collect();
    let mut hash = Hash::new();
    for (_, body) in world.bodies.iter() {
        for x in body.translation().to_array() {
            hash.add(x.to_bits().into());
        }
    }
    (steps, hash.short())
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let at = args.iter().position(|a| a == name);
        at.and_then(|at| args.get(at + 1)).cloned()
    };
    let (form, primitives) = (value("--form"), value("--primitives"));
    let wanted = |of: &Option<String>, name: String| of.as_ref().is_none_or(|of| *of == name);
    println!("{}", processor());
    println!("{BODIES} bodies, {STEPS} steps, ms a step: mean, median, most, mean to the first");
    for form in FORMS.iter().filter(|f| wanted(&form, format!("{f:?}"))) {
        let counts: Vec<usize> = PRIMITIVES
            .into_iter()
            .filter(|n| wanted(&primitives, n.to_string()))
            .collect();
        let meshes: Vec<MedialMesh> = counts.iter().map(|n| detailed(*form, *n)).collect();
        // Mass is measured at the first call.
        for mesh in &meshes {
            mesh.mass_properties(1.0);
        }
        let mut least = vec![(vec![f64::MAX; STEPS], String::new()); meshes.len()];
        for _ in 0..TURNS {
            for (mesh, least) in meshes.iter().zip(&mut least) {
                let (steps, hash) = run(mesh);
                let faster = |(a, b): (f64, &f64)| a.min(*b);
                *least = (steps.into_iter().zip(&least.0).map(faster).collect(), hash);
            }
        }
        let mean = |steps: &[f64]| steps.iter().sum::<f64>() / STEPS as f64;
        let first = least.first().map_or(1.0, |(steps, _)| mean(steps));
        for (count, (steps, hash)) in counts.iter().zip(&mut least) {
            let (mean, most) = (mean(steps), steps.iter().copied().fold(0.0, f64::max));
            println!(
                "{:<8}{count:>5}{mean:>9.3}{:>9.3}{most:>9.3}{:>8.2}  {hash}",
                format!("{form:?}"),
                median(steps),
                mean / first,
            );
        }
    }
}
