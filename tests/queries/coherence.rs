//! A body pushed slowly through another, trembling: its contact normal jumps only where the bodies'
//! geometry leaves no choice, judged by the support function of the pair alone.

use crate::ccd::distance::Corners;
use crate::ccd::rng::Rng;
use crate::penetration::largest_gap;
use nalgebra::Vector3;
use parry3d::query::{ContactManifold, PersistentQueryDispatcher};
use rapier3d::parry as parry3d;
use rapier3d_medial::elementary::penetration::HYSTERESIS;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

const STEPS: usize = 200;

/// How far a body is off its way in a step, as a solver leaves it: less than half the hysteresis of
/// the depths met, which are at least 0.16.
const TREMBLE: Real = 5.0e-3;

/// Cosine of 10°: normals further apart than this have jumped.
const JUMP: Real = 0.985;

/// Error of a gap in `f32`, and of the search for the largest.
const CLOSE: f64 = 1.0e-4;

struct Push {
    name: &'static str,
    still: Vec<MedialSphere>,
    moved: Vec<MedialSphere>,
    from: Vector,
    to: Vector,
    /// Jumps that the geometry asks for: round bodies that pass beside each other may turn the normal
    /// over by way of the side, in two.
    jumps: std::ops::RangeInclusive<usize>,
}

fn mesh(spheres: &[MedialSphere]) -> MedialMesh {
    let (edges, faces) = match spheres.len() {
        1 => (vec![], vec![]),
        2 => (vec![[0, 1]], vec![]),
        _ => (vec![], vec![[0, 1, 2]]),
    };
    MedialMesh::new(spheres.to_vec(), edges, faces).expect("a primitive")
}

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z).map(f64::from)
}

/// Differences of the spheres, the moved body being at `at`.
fn corners(push: &Push, at: Vector) -> Corners {
    let mut corners = Corners::new();
    for a in &push.still {
        for b in &push.moved {
            let z = wide(b.center) + wide(at) - wide(a.center);
            corners.push(z, f64::from(a.radius) + f64::from(b.radius));
        }
    }
    corners
}

/// Pushes step by step; tells how often the normal jumped, how often it turned over along the
/// way, and which steps are wrong.
fn run(push: &Push, rng: &mut Rng) -> (usize, usize, Vec<String>) {
    let (still, moved) = (mesh(&push.still), mesh(&push.moved));
    let dispatcher = MedialDispatcher::default();
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    let mut workspace = None;
    let mut old: Option<Vector> = None;
    let (mut jumps, mut turns, mut failures) = (0, 0, Vec::new());
    let way = (push.to - push.from).normalize();
    let mut side: Real = 0.0;
    for step in 0..=STEPS {
        let part = step as Real / STEPS as Real;
        let off = rng.in_ball().map(|x| x as Real) * TREMBLE;
        let at = push.from.lerp(push.to, part) + Vector::new(off.x, off.y, off.z);
        dispatcher
            .contact_manifolds(
                &Pose::from_translation(at),
                &still,
                &moved,
                0.01,
                &mut manifolds,
                &mut workspace,
            )
            .expect("medial meshes");
        let Some((n, point)) = manifolds.first().map(|m| (m.local_n1, m.points[0])) else {
            old = None;
            continue;
        };
        let corners = corners(push, at);
        let along = corners.support(&wide(n));
        let best = largest_gap(&corners, 1.0e-6, rng).max(along);
        let least = best - best.abs() * HYSTERESIS;
        if along < least - CLOSE || (f64::from(point.dist) - along).abs() > CLOSE {
            let dist = point.dist;
            failures.push(format!(
                "{step}: {dist} told, {along} along {n}, {best} possible"
            ));
        }
        if let Some(old) = old.filter(|old| old.dot(n) < JUMP) {
            jumps += 1;
            let kept = corners.support(&wide(old));
            if kept > least + CLOSE {
                failures.push(format!("{step}: {kept} along {old}, yet {n} with {along}"));
            }
        }
        old = Some(n);
        if n.dot(way).abs() > 0.5 {
            turns += usize::from(n.dot(way) * side < 0.0);
            side = n.dot(way);
        }
    }
    (jumps, turns, failures)
}

fn sphere(x: Real, y: Real, z: Real, radius: Real) -> MedialSphere {
    MedialSphere::new(Vector::new(x, y, z), radius)
}

fn pushes() -> Vec<Push> {
    let down = |from: Real| {
        (
            Vector::new(0.02, 0.01, from),
            Vector::new(0.02, 0.01, -from),
        )
    };
    let plate = vec![
        sphere(-1.0, -0.8, 0.0, 0.1),
        sphere(1.1, -0.7, 0.05, 0.12),
        sphere(0.1, 1.2, -0.04, 0.08),
    ];
    let push = |name, still: &[MedialSphere], moved: &[MedialSphere], (from, to), jumps| Push {
        name,
        still: still.to_vec(),
        moved: moved.to_vec(),
        from,
        to,
        jumps,
    };
    let fin = [
        sphere(0.0, -0.3, 0.5, 0.1),
        sphere(0.1, 0.4, 0.4, 0.1),
        sphere(0.0, 0.0, -0.5, 0.08),
    ];
    let rod = [sphere(-0.6, 0.0, 0.0, 0.1), sphere(0.6, 0.0, 0.0, 0.1)];
    let taper = [sphere(-0.5, 0.0, 0.0, 0.12), sphere(0.7, 0.0, 0.0, 0.08)];
    let across = [sphere(0.0, -0.6, 0.0, 0.1), sphere(0.0, 0.6, 0.0, 0.12)];
    let upright = [sphere(0.0, 0.0, -0.5, 0.1), sphere(0.0, 0.0, 0.5, 0.1)];
    let endwise = (Vector::X * 1.6, Vector::X * -1.6);
    vec![
        push(
            "a slab edge on through a slab",
            &plate,
            &fin,
            down(1.0),
            1..=1,
        ),
        push(
            "a slab flat through a slab",
            &plate,
            &plate,
            down(0.4),
            1..=1,
        ),
        push("parallel cones", &rod, &taper, down(0.4), 1..=2),
        push(
            "equal parallel cones",
            &rod,
            &rod,
            (Vector::Z * 0.4, Vector::Z * -0.4),
            1..=2,
        ),
        push("crossing cones", &rod, &across, down(0.4), 1..=1),
        push("cones end to end", &rod, &taper, endwise, 2..=2),
        push(
            "a capsule through an edge",
            &plate,
            &upright,
            (Vector::Y * -1.2, Vector::Y * 0.1),
            2..=2,
        ),
        push(
            "spheres",
            &rod[..1],
            &taper[..1],
            (Vector::new(-0.1, 0.0, 0.3), Vector::new(-0.1, 0.0, -0.3)),
            1..=2,
        ),
    ]
}

#[test]
fn normals_turn_over_only_where_the_bodies_leave_no_choice() {
    let mut wrong = Vec::new();
    for push in pushes() {
        for seed in 0..4 {
            let (jumps, turns, failures) = run(&push, &mut Rng::new(900 + seed));
            if !push.jumps.contains(&jumps) || turns > 1 || !failures.is_empty() {
                let first = failures.first();
                wrong.push(format!(
                    "{}: {jumps} jumps, {turns} turns, {} wrong: {first:?}",
                    push.name,
                    failures.len()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
