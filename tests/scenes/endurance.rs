//! A world that users do everything to, for long: no panic, no state that is not finite, counters that
//! agree.
//!
//! The full run, 100,000 steps:
//! `cargo test --all-features --test scenes a_world_lives_long -- --ignored --nocapture`
//!
//! rapier 0.36.1 has two limits here, with its own compounds as well, by debug assertions:
//! `Collider::set_shape` on a composite in contact (`tests/known_issues.rs`), so a shape is swapped by
//! a new collider; and, in 2 of 181 runs of 3,000 steps with compounds, a collider that changes its parent.

use crate::bodies::*;
use crate::rng::Rng;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::collections::HashSet;

/// Most bodies at a time.
const BODIES: usize = 24;

struct Life {
    world: PhysicsWorld,
    pipeline: MedialPipeline,
    rng: Rng,
    meshes: Vec<MedialMesh>,
    /// Bodies that were given a state that is not finite.
    poisoned: HashSet<RigidBodyHandle>,
    done: [u32; DEEDS.len()],
}

type Deed = fn(&mut Life);

const DEEDS: [(&str, Deed); 11] = [
    ("spawn", Life::spawn),
    ("spawn again", Life::spawn),
    ("remove", Life::remove),
    ("teleport", Life::teleport),
    ("sleep", Life::sleep),
    ("swap shape", Life::swap_shape),
    ("change parent", Life::change_parent),
    ("poison", Life::poison),
    ("switch", Life::switch),
    ("kick", Life::kick),
    ("save and load", Life::save_and_load),
];

fn vector(v: nalgebra::Vector3<f64>) -> Vector {
    Vector::new(v.x as Real, v.y as Real, v.z as Real)
}

impl Life {
    fn new(seed: u64) -> Self {
        let mut world = world_with_ground();
        let pipeline = attached(&mut world);
        let slab = MedialMesh::new(
            [[0.0, 0.0, 0.0], [0.6, 0.0, 0.0], [0.0, 0.0, 0.5]]
                .map(|c| MedialSphere::new(c.into(), 0.08))
                .to_vec(),
            vec![],
            vec![[0, 1, 2]],
        );
        Self {
            world,
            pipeline,
            rng: Rng::new(seed),
            meshes: vec![
                ring(12, 0.4, 0.08),
                ring(7, 0.2, 0.05),
                slab.expect("a slab"),
            ],
            poisoned: HashSet::new(),
            done: [0; DEEDS.len()],
        }
    }

    fn collider(&mut self) -> ColliderBuilder {
        match self.rng.below(5) {
            0 => ColliderBuilder::ball(0.2),
            1 => ColliderBuilder::cuboid(0.2, 0.1, 0.3),
            k => ColliderBuilder::medial_mesh(self.meshes[k - 2].clone()),
        }
    }

    fn body(&mut self) -> Option<RigidBodyHandle> {
        let handles: Vec<_> = self.world.bodies.iter().map(|(h, _)| h).collect();
        (!handles.is_empty()).then(|| handles[self.rng.below(handles.len())])
    }

    fn pose(&mut self) -> Pose {
        let at = vector(self.rng.in_ball() * 2.0) + Vector::Y * 2.2;
        Pose::new(at, vector(self.rng.in_ball() * 3.0))
    }

    fn spawn(&mut self) {
        if self.world.bodies.len() >= BODIES {
            return self.remove();
        }
        let collider = self.collider();
        let body = match self.rng.below(8) {
            0 => RigidBodyBuilder::kinematic_velocity_based(),
            1 => RigidBodyBuilder::fixed(),
            _ => RigidBodyBuilder::dynamic().ccd_enabled(self.rng.chance(0.3)),
        };
        let body = body
            .pose(self.pose())
            .linvel(vector(self.rng.in_ball() * 20.0));
        self.world.insert(body, collider.density(500.0));
    }

    fn remove(&mut self) {
        if let Some(h) = self.body() {
            self.world.remove_body(h);
            self.poisoned.remove(&h);
        }
    }

    fn teleport(&mut self) {
        let pose = self.pose();
        if let Some(h) = self.body() {
            self.world.bodies[h].set_position(pose, true);
        }
    }

    fn sleep(&mut self) {
        if let Some(h) = self.body() {
            self.world.bodies[h].sleep();
        }
    }

    fn swap_shape(&mut self) {
        let collider = self.collider();
        if let Some(h) = self.body()
            && let Some(c) = self.world.bodies[h].colliders().first().copied()
        {
            self.world.remove_collider(c);
            self.world.insert_collider(collider.density(500.0), Some(h));
        }
    }

    fn change_parent(&mut self) {
        if let (Some(a), Some(b)) = (self.body(), self.body())
            && let Some(c) = self.world.bodies[a].colliders().first().copied()
        {
            let world = &mut self.world;
            world.colliders.set_parent(c, Some(b), &mut world.bodies);
        }
    }

    fn poison(&mut self) {
        let kind = self.rng.below(5);
        let Some(h) = self.body() else { return };
        self.poisoned.insert(h);
        let body = &mut self.world.bodies[h];
        match kind {
            0 => body.set_translation(Vector::splat(Real::NAN), true),
            1 => body.set_linvel(Vector::new(0.0, Real::NAN, 0.0), true),
            2 => body.set_angvel(Vector::splat(Real::INFINITY), true),
            3 => body.set_linvel(Vector::splat(1.0e30), true),
            _ => body.set_rotation(Rotation::from_xyzw(Real::NAN, 0.0, 0.0, 1.0), true),
        }
    }

    fn switch(&mut self) {
        if let Some(h) = self.body()
            && let Some(c) = self.world.bodies[h].colliders().first().copied()
        {
            let collider = &mut self.world.colliders[c];
            match self.rng.below(2) {
                0 => collider.set_enabled(!collider.is_enabled()),
                _ => collider.set_sensor(!collider.is_sensor()),
            }
        }
    }

    fn kick(&mut self) {
        let (v, w) = (self.rng.in_ball() * 200.0, self.rng.in_ball() * 50.0);
        if let Some(h) = self.body() {
            self.world.bodies[h].set_linvel(vector(v), true);
            self.world.bodies[h].set_angvel(vector(w), true);
        }
    }

    #[cfg(feature = "serde-serialize")]
    fn save_and_load(&mut self) {
        use rapier3d_medial::rapier::{SavedWorldError, load_world, save_world};
        match save_world(&self.world) {
            Ok(bytes) => {
                self.world = load_world(&bytes).expect("what was just saved");
                self.pipeline = attached(&mut self.world);
            }
            Err(e) => assert!(matches!(e, SavedWorldError::Removed(_)), "{e}"),
        }
    }

    #[cfg(not(feature = "serde-serialize"))]
    fn save_and_load(&mut self) {}

    fn step(&mut self, step: usize) {
        for _ in 0..self.rng.below(3) {
            // Worlds are seldom saved: the rest should have time to go wrong.
            let deed = self.rng.below(DEEDS.len());
            if deed + 1 == DEEDS.len() && self.rng.chance(0.8) {
                continue;
            }
            self.done[deed] += 1;
            DEEDS[deed].1(self);
        }
        // What falls off the ground, or was disabled by rapier for its state, goes.
        if step.is_multiple_of(50) {
            let gone = |(h, b): (RigidBodyHandle, &RigidBody)| {
                let far = !b.position().is_finite() || b.translation().length() > 100.0;
                (far || self.poisoned.contains(&h)).then_some(h)
            };
            let gone: Vec<_> = self.world.bodies.iter().filter_map(gone).collect();
            for h in gone {
                self.world.remove_body(h);
                self.poisoned.remove(&h);
            }
        }
        let report = self.pipeline.step(&mut self.world);
        let enabled = self.world.colliders.iter_enabled();
        let medial = enabled.filter(|(_, c)| c.shape().as_shape::<MedialMesh>().is_some());
        let medial = medial.count();
        for (h, b) in self.world.bodies.iter() {
            let sound =
                b.position().is_finite() && b.linvel().is_finite() && b.angvel().is_finite();
            assert!(
                sound || self.poisoned.contains(&h),
                "step {step}: {h:?} at {:?}, {} {}",
                b.position(),
                b.linvel(),
                b.angvel()
            );
        }
        assert!(
            report.medial_colliders == medial && report.jobs <= report.pairs,
            "step {step}: {medial} medial colliders, {report:?}"
        );
        assert!(
            report.pairs <= medial * medial.saturating_sub(1) / 2,
            "{report:?}"
        );
    }
}

#[test]
fn a_world_lives_through_everything() {
    let mut life = Life::new(7);
    for step in 0..3000 {
        life.step(step);
    }
    for (k, (name, _)) in DEEDS.iter().enumerate() {
        assert!(life.done[k] > 20, "{name}: {} times", life.done[k]);
    }
}

/// Resident memory in MiB, where the system tells.
fn resident() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: f64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * 4096.0 / (1 << 20) as f64)
}

#[test]
#[ignore = "minutes: 100,000 steps; CI lives through 3,000"]
fn a_world_lives_long() {
    let mut life = Life::new(8);
    let mut memory = Vec::new();
    for step in 0..100_000 {
        life.step(step);
        if step % 10_000 == 9_999 {
            memory.push(resident().unwrap_or(0.0));
        }
    }
    println!("{:?}", life.done);
    println!("resident memory every 10,000 steps, MiB: {memory:.1?}");
    let (early, late) = (memory[1], memory[9]);
    assert!(late < early * 1.3 + 8.0, "memory grows: {memory:.1?}");
}
