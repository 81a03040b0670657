//! All elementary pairs of a frame, as the paper tests them: nothing is culled.

use crate::common::scene::Scene;
use rapier3d::prelude::*;
use rapier3d_medial::MedialSphere;
use rapier3d_medial::elementary::bracket::Limits;
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, for_each_test};
use rapier3d_medial::elementary::{MovingSphere, ToiOptions, alternating};
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::math::tolerance;
use rapier3d_medial::pair::PrimitiveTree;
use std::hint::black_box;
use std::time::Instant;

/// Only every such pair of primitives is asked by the paper's iteration, and the time multiplied.
const PAPER_SHARE: usize = 50;

/// What a frame took.
pub struct Brute {
    /// Elementary tests, shared edges and spheres once.
    pub tests: usize,
    /// All of them by the certified query, eight lanes at a time.
    pub lanes_milliseconds: f64,
    /// By the paper's iteration in `f32`, from a share of the pairs of primitives.
    pub paper_milliseconds: f64,
}

/// The spheres of each primitive of a body, in motion.
type Moving = Vec<Vec<MovingSphere>>;

/// Every pair of bodies of which one at least moves, on straight paths from pose to pose.
pub fn brute_force(scene: &Scene, before: &[Pose], after: &[Pose]) -> Brute {
    let fixed = |b: usize| scene.actors[b].start.body_type == RigidBodyType::Fixed;
    let pairs: Vec<[usize; 2]> = (0..before.len())
        .flat_map(|j| (0..j).map(move |i| [i, j]))
        .filter(|&[i, j]| !(fixed(i) && fixed(j)))
        .collect();
    let moving: Vec<Moving> = (0..before.len())
        .map(|b| {
            let place = |s: &MedialSphere| {
                let [start, end] = [before[b], after[b]].map(|p| p.transform_point(s.center));
                MovingSphere {
                    center: start,
                    radius: s.radius,
                    displacement: end - start,
                }
            };
            let mesh = &scene.actors[b].model.medial;
            let one = |k| {
                PrimitiveTree::primitive(mesh, k)
                    .0
                    .iter()
                    .map(place)
                    .collect()
            };
            (0..mesh.primitive_count() as u32).map(one).collect()
        })
        .collect();
    let start = Instant::now();
    let tests = pairs.iter().map(|p| in_lanes(scene, &moving, *p)).sum();
    let lanes_milliseconds = 1.0e3 * start.elapsed().as_secs_f64();
    let start = Instant::now();
    for pair in &pairs {
        by_the_paper(&moving, *pair);
    }
    Brute {
        tests,
        lanes_milliseconds,
        paper_milliseconds: 1.0e3 * start.elapsed().as_secs_f64() * PAPER_SHARE as f64,
    }
}

fn in_lanes(scene: &Scene, moving: &[Moving], [i, j]: [usize; 2]) -> usize {
    let limits = Limits {
        tolerance: tolerance::TOLERANCE,
        time_tolerance: tolerance::TIME_TOLERANCE,
        start: 0.0,
        horizon: 1.0,
        max_iterations: tolerance::MAX_ITERATIONS,
    };
    let [a, b] = [i, j].map(|k| &scene.actors[k].model.medial);
    let mut count = 0;
    for first in 0..a.primitive_count() as u32 {
        let share1 = PrimitiveTree::primitive(a, first).1;
        let spheres1 = &moving[i][first as usize];
        let mut paths = [Vec::new(), Vec::new()];
        for second in 0..b.primitive_count() as u32 {
            let share2 = PrimitiveTree::primitive(b, second).1;
            let spheres2 = &moving[j][second as usize];
            for_each_test(share1, share2, |test| {
                let path = LinearPath::new(&test, 0.0, |other, k| {
                    let s = &if other { spheres2 } else { spheres1 }[k as usize];
                    let vec = Vec3::from_vector;
                    (vec(s.center), vec(s.displacement), s.radius)
                });
                paths[usize::from(test.domain == Domain::Triangle)].push(path);
                true
            });
        }
        for (paths, domain) in paths.iter().zip([Domain::Box, Domain::Triangle]) {
            count += paths.len();
            black_box(brackets(paths, domain, &limits, Lanes::Fastest));
        }
    }
    count
}

fn by_the_paper(moving: &[Moving], [i, j]: [usize; 2]) {
    let options = ToiOptions::default();
    let all = moving[i]
        .iter()
        .flat_map(|p| moving[j].iter().map(move |q| (p, q)));
    // Not the first of each run, so that pairs of bodies with few primitives have their share too.
    for (p, q) in all.skip((i + 7 * j) % PAPER_SHARE).step_by(PAPER_SHARE) {
        black_box(alternating(p, q, &options));
    }
}
