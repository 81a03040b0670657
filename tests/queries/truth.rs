//! The ground truth of the example `accuracy_vs_time`: first contact of moving triangle meshes,
//! against closed forms, and against dense sampling in time with bisection, which shares only the
//! distance of two triangles with it. That distance is judged by points spread over both.

use crate::truth_of_examples::mesh::Mesh;
use crate::truth_of_examples::triangle_toi::{
    Motion, TriangleBody, first_contact, triangle_distance,
};
use nalgebra::{Point3, Vector3};
use rapier3d::parry::shape::Cuboid;
use rapier3d::prelude::{Real, Vector};

type V = Vector3<f64>;

const TOUCH: f64 = 1.0e-9;

fn cuboid(x: Real, y: Real, z: Real) -> Mesh {
    let (vertices, indices) = Cuboid::new(Vector::new(x, y, z)).to_trimesh();
    Mesh { vertices, indices }
}

fn motion(start: [f64; 3], velocity: [f64; 3], turn: [f64; 3]) -> Motion {
    Motion {
        start: start.into(),
        velocity: velocity.into(),
        turn: turn.into(),
    }
}

const STILL: [f64; 3] = [0.0; 3];

fn time(meshes: [&Mesh; 2], motions: [&Motion; 2]) -> Option<f64> {
    let bodies = meshes.map(TriangleBody::new);
    first_contact([&bodies[0], &bodies[1]], motions, 1.0, TOUCH)
}

#[test]
fn boxes_that_approach_meet_when_the_gap_is_gone() {
    let (a, b) = (cuboid(0.5, 0.25, 0.25), cuboid(0.25, 1.0, 1.0));
    for (speed, expected) in [(4.0, Some(0.5625)), (2.0, None), (9.0, Some(0.25))] {
        let moves = motion([-3.0, 0.1, 0.2], [speed, 0.0, 0.0], STILL);
        let found = time([&a, &b], [&moves, &motion(STILL, STILL, STILL)]);
        match expected {
            Some(expected) => assert!((found.expect("a hit") - expected).abs() < 1.0e-8),
            None => assert_eq!(found, None),
        }
    }
}

/// The corner of a bar at distance √(a² + b²), b half its thickness, reaches the height h of a plane at
/// the angle asin(h / √(a² + b²)) − atan(b / a).
#[test]
fn a_turning_bar_meets_a_plate_at_its_angle() {
    let (a, b) = (1.0f64, 0.125f64);
    let (bar, plate) = (cuboid(1.0, 0.125, 0.125), cuboid(2.0, 0.25, 2.0));
    for (rate, height) in [(1.0, 0.5f64), (3.0, 0.75), (6.0, 0.25)] {
        let angle = (height / (a * a + b * b).sqrt()).asin() - (b / a).atan();
        let turns = motion(STILL, STILL, [0.0, 0.0, rate]);
        let stands = motion([0.0, height + 0.25, 0.0], STILL, STILL);
        let found = time([&bar, &plate], [&turns, &stands]).expect("a hit");
        assert!((found - angle / rate).abs() < 1.0e-8, "{found}");
    }
}

#[test]
fn tumbling_boxes_meet_when_dense_samples_and_bisection_say_so() {
    let (a, b) = (cuboid(0.7, 0.1, 0.3), cuboid(0.2, 0.4, 0.6));
    let mut hits = 0;
    let mut state = 7u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    const CASES: usize = 40;
    for _ in 0..CASES {
        let mut vector = |size: f64| [0; 3].map(|_| size * random());
        let (side, turns) = (vector(1.6), [vector(4.0), vector(4.0)]);
        let first = motion([-2.5, side[1], side[2]], [4.0, 0.0, 0.0], turns[0]);
        let second = motion(STILL, STILL, turns[1]);
        let found = time([&a, &b], [&first, &second]);
        let sampled = sampled([&a, &b], [&first, &second]);
        match (found, sampled) {
            (Some(found), Some(sampled)) => {
                hits += 1;
                assert!(
                    (found - sampled).abs() < 1.0e-6,
                    "{found} against {sampled}"
                );
            }
            // Samples see no contact that is over between two: it may only be missing.
            (Some(_), None) | (None, None) => {}
            (None, Some(sampled)) => panic!("a contact at {sampled} was missed"),
        }
    }
    assert!((CASES * 3 / 10..CASES).contains(&hits), "{hits} hits");
}

/// The first of 500 samples at which a pair of triangles touches, moved back by bisection.
fn sampled(meshes: [&Mesh; 2], motions: [&Motion; 2]) -> Option<f64> {
    let touch = |time: f64| {
        let placed = [0, 1].map(|k| {
            let pose = motions[k].pose(time);
            let corner =
                |v: Vector| (pose * Point3::new(v.x.into(), v.y.into(), v.z.into())).coords;
            let triangles = meshes[k].indices.iter();
            let triangles = triangles.map(|t| meshes[k].corners(*t).map(corner));
            triangles.collect::<Vec<[V; 3]>>()
        });
        let [first, second] = &placed;
        let pierced = |a: &[V; 3]| second.iter().any(|b| triangle_distance(a, b) == 0.0);
        first.iter().any(pierced)
    };
    let steps = 500;
    let step = (1..=steps).find(|k| touch(f64::from(*k) / f64::from(steps)))?;
    let (mut low, mut high) = (
        f64::from(step - 1) / f64::from(steps),
        f64::from(step) / f64::from(steps),
    );
    for _ in 0..30 {
        let middle = (low + high) / 2.0;
        if touch(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    Some(high)
}

#[test]
fn the_distance_of_triangles_is_that_of_their_points() {
    let mut state = 3u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    const SIDE: usize = 24;
    let mut apart = 0;
    for _ in 0..60 {
        let mut corner = |at: f64| V::new(random() + at, random(), random());
        let a = [0; 3].map(|_| corner(0.0));
        let b = [0; 3].map(|_| corner(0.9));
        let exact = triangle_distance(&a, &b);
        let spread = |t: &[V; 3]| -> Vec<V> {
            let grid = (0..=SIDE).flat_map(|i| (0..=SIDE - i).map(move |j| (i, j)));
            let at = |(i, j): (usize, usize)| {
                let (u, v) = (i as f64 / SIDE as f64, j as f64 / SIDE as f64);
                t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v
            };
            grid.map(at).collect()
        };
        let (p, q) = (spread(&a), spread(&b));
        let pairs = p.iter().flat_map(|p| q.iter().map(move |q| (p - q).norm()));
        let nearest = pairs.fold(f64::MAX, f64::min);
        // Each of the two nearest points is within a cell of a grid point: an edge's length over SIDE.
        let edge = |t: &[V; 3]| (t[1] - t[0]).norm().max((t[2] - t[0]).norm()) / SIDE as f64;
        assert!(exact <= nearest + 1.0e-12, "{exact} above {nearest}");
        assert!(
            nearest <= exact + 2.0 * (edge(&a) + edge(&b)),
            "{exact} far below {nearest}"
        );
        apart += usize::from(exact > 0.0);
    }
    assert!((20..60).contains(&apart), "{apart} apart");
}
