//! When do two rotating tori meet? The medial mesh beside what parry offers for a concave body:
//! convex hull, convex decomposition, triangle mesh, voxels.
//!
//! `cargo bench --bench peers`. All shapes answer the same seeded motions in one run, motion by
//! motion. The judge is the true torus, not any of the meshes, and shares nothing with the crate.
//! Prints medians in µs, the error of the time, and a hash of the times.

mod common;
mod torus;

use common::{Hash, median, processor};
use rapier3d::math::{Pose, Vector};
use rapier3d::parry::query::{NonlinearRigidMotion, cast_shapes_nonlinear};
use rapier3d::parry::shape::{Compound, SharedShape};
use rapier3d::parry::transformation::vhacd::VHACDParameters;
use rapier3d::parry::transformation::voxelization::FillMode;
use rapier3d_medial::pair::first_contact::first_contact;
use rapier3d_medial::{MedialMesh, ToiOptions, ToiStatus};
use std::time::Instant;
use torus::{MINOR, Meeting, approaching, linked, ring, surface};

/// Motions in which the tori meet, and in which they pass each other closely.
const HITS: usize = 24;
const MISSES: usize = 8;

enum Body {
    Medial(MedialMesh),
    Parry(SharedShape),
}

impl Body {
    /// Time of the first contact, as a fraction of the step of one second.
    fn meet(&self, motions: &[NonlinearRigidMotion; 2]) -> Option<f64> {
        let [m1, m2] = motions;
        match self {
            Self::Medial(mesh) => {
                let toi = first_contact(mesh, m1, mesh, m2, 1.0, &ToiOptions::default());
                (toi.status != ToiStatus::Separated).then_some(f64::from(toi.lower))
            }
            Self::Parry(shape) => cast_shapes_nonlinear(m1, &**shape, m2, &**shape, 0.0, 1.0, true)
                .expect("a pair that parry supports")
                .map(|hit| f64::from(hit.time_of_impact)),
        }
    }
}

struct Peer {
    name: &'static str,
    body: Body,
    parts: usize,
    /// Seconds it took to build.
    build: f64,
    /// It runs one motion in so many: the slow ones few.
    every: usize,
    /// Timed calls for each motion.
    calls: usize,
}

impl Peer {
    fn new(
        name: &'static str,
        [every, calls]: [usize; 2],
        build: impl FnOnce() -> (Body, usize),
    ) -> Self {
        let clock = Instant::now();
        let (body, parts) = build();
        Self {
            name,
            body,
            parts,
            build: clock.elapsed().as_secs_f64(),
            every,
            calls,
        }
    }
}

/// What a peer made of a group of motions.
struct Record {
    micros: Vec<f64>,
    errors: Vec<f64>,
    /// Motions without a true contact, or with one, that it took for the opposite; and all of them.
    false_hits: [usize; 2],
    missed: [usize; 2],
    hash: Hash,
}

impl Record {
    fn new() -> Self {
        Self {
            micros: Vec::new(),
            errors: Vec::new(),
            false_hits: [0; 2],
            missed: [0; 2],
            hash: Hash::new(),
        }
    }

    fn run(&mut self, peer: &Peer, meeting: &Meeting) {
        let mut found = None;
        for _ in 0..peer.calls {
            let clock = Instant::now();
            found = peer.body.meet(&meeting.motions);
            self.micros.push(clock.elapsed().as_secs_f64() * 1e6);
        }
        self.hash.add(found.unwrap_or(-1.0).to_bits());
        if let (Some(time), Some(found)) = (meeting.time, found) {
            self.errors.push(found - time);
        }
        let wrong = usize::from(meeting.time.is_some() != found.is_some());
        let count = match meeting.time {
            Some(_) => &mut self.missed,
            None => &mut self.false_hits,
        };
        *count = [count[0] + wrong, count[1] + 1];
    }
}

fn decomposition(resolution: u32, concavity: f32) -> (Body, usize) {
    let (points, triangles) = surface();
    let parameters = VHACDParameters {
        resolution,
        concavity,
        ..Default::default()
    };
    let shape = SharedShape::convex_decomposition_with_params(&points, &triangles, &parameters);
    let parts = shape.as_shape::<Compound>().map_or(1, |c| c.shapes().len());
    (Body::Parry(shape), parts)
}

fn peers() -> Vec<Peer> {
    let (points, triangles) = surface();
    let medial = |n: u32| (Body::Medial(ring(n)), n as usize);
    let default = VHACDParameters::default();
    let (resolution, concavity) = (default.resolution, default.concavity);
    vec![
        Peer::new("medial mesh, 27 cones", [1, 5], || medial(27)),
        Peer::new("medial mesh, 64 cones", [1, 5], || medial(64)),
        Peer::new("convex hull", [1, 5], || {
            let hull = SharedShape::convex_hull(&points).expect("a hull of a torus");
            (Body::Parry(hull), 1)
        }),
        Peer::new("VHACD, default", [1, 1], || {
            decomposition(resolution, concavity)
        }),
        Peer::new("VHACD, 128 / 0.001", [1, 1], || decomposition(128, 0.001)),
        Peer::new("voxels of r / 4", [1, 1], || {
            let fill = FillMode::FloodFill {
                detect_cavities: false,
            };
            let shape = SharedShape::voxelized_mesh(&points, &triangles, MINOR as f32 / 4.0, fill);
            let parts = shape.as_voxels().map_or(0, |v| v.voxels().count());
            (Body::Parry(shape), parts)
        }),
        Peer::new("triangle mesh", [8, 1], || {
            let shape = SharedShape::trimesh(points.clone(), triangles.clone());
            let parts = triangles.len();
            (Body::Parry(shape.expect("a triangle mesh")), parts)
        }),
    ]
}

/// One motion on its own: two tori approach along X, one upright in the other's way, both spinning.
fn head_on() -> Meeting {
    let motion = |x: f32, turn: Vector, velocity: f32, spin: Vector| {
        let start = Pose::new(Vector::new(x, 0.1, 0.0), turn);
        NonlinearRigidMotion::new(start, Vector::ZERO, Vector::X * velocity, spin)
    };
    let turn = Vector::new(1.2, 0.3, 0.0);
    Meeting::new([
        motion(0.0, Vector::ZERO, 0.5, Vector::new(0.3, 1.0, 0.4)),
        motion(1.6, turn, -1.5, Vector::new(-0.5, 0.8, 1.5)),
    ])
}

fn race(title: &str, peers: &[Peer], motions: &[Meeting]) {
    let mut records: Vec<Record> = peers.iter().map(|_| Record::new()).collect();
    for (k, meeting) in motions.iter().enumerate() {
        for (peer, record) in peers.iter().zip(&mut records) {
            if k % peer.every == 0 {
                record.run(peer, meeting);
            }
        }
    }
    println!("\n{title}");
    println!(
        "{:<23}{:>11}{:>9}{:>10}{:>10}{:>10}{:>9}{:>8}{:>10}",
        "", "median µs", "ratio", "error", "earliest", "latest", "missed", "false", "hash"
    );
    let mut first = None;
    for (peer, record) in peers.iter().zip(&mut records) {
        let micros = median(&mut record.micros);
        let ratio = micros / *first.get_or_insert(micros);
        let error = median(&mut record.errors);
        let end = |error: Option<&f64>| error.copied().unwrap_or(f64::NAN);
        let (earliest, latest) = (end(record.errors.first()), end(record.errors.last()));
        let of = |[wrong, all]: [usize; 2]| format!("{wrong}/{all}");
        println!(
            "{:<23}{micros:>11.1}{ratio:>9.1}{error:>10.5}{earliest:>10.5}{latest:>10.5}{:>9}{:>8}{:>10}",
            peer.name,
            of(record.missed),
            of(record.false_hits),
            record.hash.short()
        );
    }
}

fn main() {
    println!("{}, one core", processor());
    let peers = peers();
    for peer in &peers {
        println!(
            "{:<23}{:>6} parts, built in {:.3} s",
            peer.name, peer.parts, peer.build
        );
    }
    let head_on = head_on();
    print!("\nhead-on: true time {:.5}", head_on.time.unwrap_or(1.0));
    for peer in &peers {
        match peer.body.meet(&head_on.motions) {
            Some(time) => print!(", {} {time:.5}", peer.name),
            None => print!(", {} missed", peer.name),
        }
    }
    println!("\n\nerror: time found minus true time, in the step of 1 s; ratio: of medians");
    let mut apart = vec![head_on];
    apart.extend(approaching(HITS, MISSES));
    race("Apart at the start", &peers, &apart);
    race("Linked at the start", &peers, &linked(HITS / 2, MISSES / 2));
}
