//! A heap of rings at rest, sleeping off: what a step costs as medial meshes, as rapier's convex
//! hulls, as parry's convex decomposition, as triangle meshes and as voxels.
//!
//! ```text
//! cargo bench --bench piles                    # 30, 200 and 1,000 rings: minutes
//! cargo bench --bench piles -- --rings 30 --recycle 0.01
//! cargo bench --bench piles -- --settle 900    # steps before the first turn
//! cargo bench --bench piles -- --heaps 7       # of how many heaps the ratio is told
//! ```
//!
//! What a heap costs depends on whether something in it still rolls, more than on what it is made of. So
//! of all kinds one heap is shown, and of the decomposition the ratio over many, whose rings are tilted
//! otherwise. Of 1,000 rings there is one heap.
//!
//! Every kind gets the same rings at the same places, rapier's defaults, and time to settle. Then
//! the kinds take turns, nine times: the ratios of one turn are of the same minute of the machine.
//! `--recycle` sets rapier's contact recycle distance after `attach`, which sets 0.004.
//! Hulls settle into another heap (they have no hole), so theirs is another scene of equal numbers.

mod common;
mod torus;

use common::{Hash, median, processor};
use rapier3d::parry::transformation::voxelization::FillMode;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::time::Instant;
use torus::{MINOR, ring, surface};

/// Turns of each kind; the spread is taken over them.
const TURNS: usize = 9;
/// Half a second of simulated time a turn.
const STEPS: usize = 30;
/// Four seconds to settle, unless `--settle` says otherwise.
const SETTLE: Real = 240.0;
/// Above this many rings only the medial mesh, the hull and the decomposition run.
const ALL_KINDS: usize = 30;
/// Heaps, unless `--heaps` says otherwise, of up to [`MANY`] rings.
const HEAPS: Real = 21.0;
const MANY: usize = 200;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Medial,
    Hull,
    Decomposition,
    Triangles,
    Voxels,
}

impl Kind {
    const ALL: [Kind; 5] = [
        Kind::Medial,
        Kind::Hull,
        Kind::Decomposition,
        Kind::Triangles,
        Kind::Voxels,
    ];

    fn name(self) -> &'static str {
        match self {
            Kind::Medial => "medial mesh, 27 cones",
            Kind::Hull => "convex hull",
            Kind::Decomposition => "VHACD, default",
            Kind::Triangles => "triangle mesh",
            Kind::Voxels => "voxels of r / 4",
        }
    }

    fn shape(self) -> SharedShape {
        let (points, triangles) = surface();
        match self {
            Kind::Medial => SharedShape::medial_mesh(ring(27)),
            Kind::Hull => SharedShape::convex_hull(&points).expect("a hull of a torus"),
            Kind::Decomposition => SharedShape::convex_decomposition(&points, &triangles),
            Kind::Triangles => SharedShape::trimesh(points, triangles).expect("a torus"),
            Kind::Voxels => {
                let fill = FillMode::FloodFill {
                    detect_cavities: false,
                };
                SharedShape::voxelized_mesh(&points, &triangles, MINOR as f32 / 4.0, fill)
            }
        }
    }
}

/// One world of rings.
struct Pile {
    kind: Kind,
    world: PhysicsWorld,
    pipeline: Option<MedialPipeline>,
    milliseconds: Vec<f64>,
}

impl Pile {
    /// Rings in layers of a square, tilted one by one, in a pen as wide as the square. From the eighth heap on
    /// they are tilted a little further.
    fn new(kind: Kind, rings: usize, heap: usize) -> Self {
        let mut world = PhysicsWorld::default();
        let side = if rings > 100 { 6 } else { 3 };
        let half = 0.75 * side as Real;
        let slab = |x: Real, y: Real, z: Real, at: Vector| {
            ColliderBuilder::cuboid(x, y, z).translation(at)
        };
        let tall = 60.0;
        world.insert_collider(slab(50.0, 0.5, 50.0, Vector::NEG_Y * 0.5), None);
        for axis in [Vector::X, Vector::NEG_X] {
            world.insert_collider(slab(0.5, tall, 50.0, axis * (half + 0.5)), None);
        }
        for axis in [Vector::Z, Vector::NEG_Z] {
            world.insert_collider(slab(50.0, tall, 0.5, axis * (half + 0.5)), None);
        }
        // All kinds weigh the same and turn alike: the mass is the body's, not the collider's.
        let mass = ring(27).mass_properties(1000.0);
        let collider = ColliderBuilder::new(kind.shape()).density(0.0);
        for k in 0..rings {
            let (layer, place) = (k / (side * side), k % (side * side));
            let at = |i: usize| (i as Real - 0.5 * (side - 1) as Real) * 1.4;
            let center = Vector::new(
                at(place % side),
                0.6 + 0.5 * layer as Real,
                at(place / side),
            );
            let further = 1.0 + 0.03 * (heap / 7) as Real;
            let tilt = Vector::new(0.3, 0.0, 0.2) * (((k + heap) % 7) as Real - 3.0) * further;
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(center, tilt))
                .additional_mass_properties(mass)
                .can_sleep(false);
            world.insert(body, collider.clone());
        }
        let pipeline = (kind == Kind::Medial).then(|| {
            let mut pipeline = MedialPipeline::new(MedialOptions::default());
            pipeline.attach(&mut world);
            if let Some(distance) = argument("--recycle") {
                world
                    .integration_parameters
                    .normalized_contact_recycle_distance = distance;
            }
            pipeline
        });
        Self {
            kind,
            world,
            pipeline,
            milliseconds: Vec::new(),
        }
    }

    fn step(&mut self, steps: usize) {
        for _ in 0..steps {
            match &mut self.pipeline {
                Some(pipeline) => drop(pipeline.step(&mut self.world)),
                None => self.world.step(),
            }
        }
    }

    fn turn(&mut self) {
        let start = Instant::now();
        self.step(STEPS);
        let seconds = start.elapsed().as_secs_f64();
        self.milliseconds.push(1e3 * seconds / STEPS as f64);
    }

    /// What the solver works on: manifolds with contacts, and contacts.
    fn solved(&self) -> [usize; 2] {
        let pairs = self.world.narrow_phase.contact_pairs();
        let manifolds = pairs.flat_map(|pair| pair.solver_manifolds());
        let contacts = manifolds.map(|m| m.data.solver_contacts.len());
        contacts
            .filter(|&n| n > 0)
            .fold([0, 0], |[m, c], n| [m + 1, c + n])
    }

    /// Mean height of the rings, and a hash of all poses.
    fn state(&self) -> (Real, String) {
        let mut hash = Hash::new();
        let (mut sum, mut count) = (0.0, 0);
        for (_, body) in self.world.bodies.iter() {
            let at = body.translation();
            for x in [at.x, at.y, at.z] {
                hash.add(x.to_bits().into());
            }
            sum += at.y;
            count += 1;
        }
        (sum / count as Real, hash.short())
    }
}

/// Lets heaps of some kinds settle; then they take turns.
fn run(rings: usize, heap: usize, kinds: impl Iterator<Item = Kind>) -> Vec<Pile> {
    let settle = argument("--settle").unwrap_or(SETTLE) as usize;
    let mut piles: Vec<Pile> = kinds.map(|kind| Pile::new(kind, rings, heap)).collect();
    piles.iter_mut().for_each(|pile| pile.step(settle));
    for _ in 0..TURNS {
        piles.iter_mut().for_each(Pile::turn);
    }
    piles
}

/// Ratios of the times of two kinds, turn by turn: the median, and all in their order.
fn ratios(medial: &Pile, other: &Pile) -> (f64, Vec<f64>) {
    let turns = medial.milliseconds.iter().zip(&other.milliseconds);
    let mut ratios: Vec<f64> = turns.map(|(m, p)| m / p).collect();
    (median(&mut ratios), ratios)
}

/// All kinds, in one heap.
fn kinds(rings: usize) {
    println!("\n{rings} rings, heap 0, {TURNS} turns of {STEPS} steps");
    println!(
        "{:<24}{:>9}{:>9}{:>16}{:>11}{:>10}{:>13}  hash",
        "", "ms/step", "ratio", "spread", "manifolds", "contacts", "mean height"
    );
    let kinds = Kind::ALL
        .into_iter()
        .filter(|kind| rings <= ALL_KINDS || !matches!(kind, Kind::Triangles | Kind::Voxels));
    let piles = run(rings, 0, kinds);
    for pile in &piles {
        let (ratio, all) = ratios(&piles[0], pile);
        let spread = format!("{:.2} to {:.2}", all[0], all[TURNS - 1]);
        let (height, hash) = pile.state();
        let [manifolds, contacts] = pile.solved();
        println!(
            "{:<24}{:>9.2}{ratio:>9.2}{spread:>16}{manifolds:>11}{contacts:>10}{height:>13.2}  {hash}",
            pile.kind.name(),
            median(&mut pile.milliseconds.clone()),
        );
    }
}

/// The medial mesh and the decomposition, in many heaps.
fn heaps(rings: usize, count: usize) {
    let mut hash = Hash::new();
    let of_heap = |heap| {
        let piles = run(rings, heap, [Kind::Medial, Kind::Decomposition].into_iter());
        for x in piles.iter().flat_map(|pile| pile.state().1.into_bytes()) {
            hash.add(x.into());
        }
        ratios(&piles[0], &piles[1]).0
    };
    let mut all: Vec<f64> = (0..count).map(of_heap).collect();
    let middle = median(&mut all);
    println!(
        "to VHACD, {count} heaps: {middle:.2}, half of them {:.2} to {:.2}, all {:.2} to {:.2}  {}",
        all[count / 4],
        all[count - 1 - count / 4],
        all[0],
        all[count - 1],
        hash.short()
    );
}

/// The number after an argument of the command line.
fn argument(name: &str) -> Option<Real> {
    let mut all = std::env::args().skip_while(|a| a != name);
    all.nth(1)?.parse().ok()
}

fn main() {
    let wanted = argument("--rings").map(|n| n as usize);
    println!("{}; ratio: medial mesh to the row's", processor());
    let sizes = wanted.map_or(vec![30, 200, 1000], |n| vec![n]);
    for rings in sizes {
        kinds(rings);
        if rings <= MANY {
            heaps(
                rings,
                argument("--heaps").unwrap_or(HEAPS).max(1.0) as usize,
            );
        }
    }
}
