//! Thin and round convex pieces that spin, slide or may overlap: when they meet, against their triangles and closed
//! forms.

use crate::ccd::rng::Rng;
use crate::convex_pieces::{V, cuboid, meets_as_its_triangles, motion};
use crate::truth_of_examples::triangle_toi::{TriangleBody, distance_at};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d::prelude::{Pose, Real, Rotation, Vector};
use rapier3d_medial::elementary::Cores;
use rapier3d_medial::meshing::Variant;
use rapier3d_medial::pair::first_contact;
use rapier3d_medial::{InitialContact, MedialMesh, ToiOptions, ToiStatus};

/// Symptom: one of some thousand rods and plates that spin by several radians went through another unseen, and others
/// met it early. Causes: a direction from an earlier part of the turn, along which corners overlap and come apart
/// again, was taken to keep them apart; and the directions of the hulls alone are poor where thin boxes are apart by a
/// ten-thousandth of their size.
#[test]
fn thin_boxes_that_spin_meet_when_their_triangles_do() {
    let halves = [
        [0.5, 0.01, 0.01],
        [1.0, 0.02, 0.02],
        [1.0, 1.0, 0.01],
        [0.5, 0.25, 0.01],
    ];
    let sources = halves.map(cuboid);
    let boxes = halves.map(|half| MedialMesh::cuboid(Vector::from_array(half)).expect("a box"));
    let mut rng = Rng::new(2611);
    let mut count = [0; 2];
    for case in 0..400 {
        let (i, j) = (case % 4, case / 4 % 4);
        let at = rng.in_ball().normalize() * rng.range(0.3, 1.0);
        let aim = at + rng.in_ball() * 0.9;
        let first = motion(at, -aim * rng.range(1.0, 2.0), rng.in_ball() * 10.0);
        let second = motion(V::zeros(), V::zeros(), V::zeros());
        let bodies = [(&sources[i], &boxes[i]), (&sources[j], &boxes[j])];
        let triangles = bodies.map(|(source, _)| TriangleBody::new(source));
        let start = distance_at([&triangles[0], &triangles[1]], [&first.0, &second.0], 0.0);
        if start < 1.0e-3 {
            continue;
        }
        let meets = meets_as_its_triangles(bodies, [&first, &second], case);
        count[usize::from(meets)] += 1;
    }
    println!("{count:?} apart, met");
    assert!(count.iter().all(|n| *n > 40), "{count:?}");
    // Found by chance among thousands.
    let [rod, post] = [0, 1].map(|k| (&sources[k], &boxes[k]));
    let at = V::new(0.226, 0.644, -0.059);
    let velocity = V::new(-0.377, -0.772, -0.675);
    let still = motion(V::zeros(), V::zeros(), V::zeros());
    for turn in [V::new(6.293, -4.5, 6.337), V::new(2.517, -1.8, 2.535)] {
        let spins = motion(at, velocity, turn);
        assert!(meets_as_its_triangles([rod, post], [&spins, &still], 400));
    }
}

/// Symptom: balls' hulls that may overlap by .1 met when they were still apart. Two cubes whose edges cross met .25
/// deep where their cores reach the edges.
#[test]
fn pieces_that_may_overlap_meet_as_deep_as_they_may() {
    let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
    let moving = |start: Pose, velocity: Vector| {
        NonlinearRigidMotion::new(start, Vector::ZERO, velocity, Vector::ZERO)
    };
    let round = MedialMesh::round_cuboid(Vector::splat(0.5), 0.2).expect("a round box");
    let deep = ToiOptions {
        target_distance: -0.1,
        ..Default::default()
    };
    let comes = moving(Pose::from_translation(Vector::X * 2.4), Vector::X * -2.0);
    let found = first_contact(&round, &still, &round, &comes, 1.0, &deep);
    assert!((found.upper - 0.55).abs() < 1.0e-4, "{found:?}");
    let cube = MedialMesh::cuboid(Vector::splat(0.5)).expect("a cube");
    let cores = ToiOptions {
        cores: Some(Cores {
            share: 0.5,
            at_most: Real::INFINITY,
            tips: 0.0,
        }),
        ..Default::default()
    };
    let quarter = std::f64::consts::FRAC_PI_4 as Real;
    let rests = moving(
        Pose::from_parts(
            Vector::ZERO,
            Rotation::from_scaled_axis(Vector::Z * quarter),
        ),
        Vector::ZERO,
    );
    let height = Real::hypot(1.0, 1.0) + 0.1;
    let edge_down = Pose::from_parts(
        Vector::Y * height,
        Rotation::from_scaled_axis(Vector::X * quarter),
    );
    let falls = moving(edge_down, -Vector::Y);
    let found = first_contact(&cube, &rests, &cube, &falls, 1.0, &cores);
    assert!((found.upper - 0.1).abs() < 1.0e-3, "{found:?}");
}

/// A spike of six sides, 1 m high, .2 m wide at its base, with its tip at the origin.
fn spike(up: bool) -> MedialMesh {
    let sign = if up { 1.0 } else { -1.0 };
    let around = (0..6).map(|k| std::f64::consts::TAU * f64::from(k) / 6.0);
    let base = around.map(|a| Vector::new((0.1 * a.cos()) as Real, -sign, (0.1 * a.sin()) as Real));
    let corners: Vec<Vector> = std::iter::once(Vector::ZERO).chain(base).collect();
    let sides = (1..7).map(|k| [0, k % 6 + 1, k]);
    let bottom = (2..6).map(|k| [1, k, k + 1]);
    let turned = |t: [u32; 3]| if up { t } else { [t[0], t[2], t[1]] };
    let triangles: Vec<[u32; 3]> = sides.chain(bottom).map(turned).collect();
    let built = MedialMesh::from_trimesh(&corners, &triangles, &Default::default());
    let (mesh, report) = built.expect("a spike");
    assert_eq!(report.variant, Variant::Exact);
    mesh
}

/// Two spikes, tip to tip, whose tips touch, slide sideways: their axes cross, so their cores meet. How deep their
/// hulls are in each other says nothing of that, because they are thin there.
#[test]
fn spikes_that_touch_do_not_pass_each_other() {
    let (up, down) = (spike(true), spike(false));
    let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
    for overlap in [0.05, 0.1, 0.3] {
        let slides = |x: Real, way: Real| {
            let start = Pose::from_translation(Vector::new(x, -overlap, 0.0));
            NonlinearRigidMotion::new(start, Vector::ZERO, Vector::X * way, Vector::ZERO)
        };
        let options = ToiOptions::default();
        let found = first_contact(&up, &still, &down, &slides(-1.0, 2.0), 1.0, &options);
        assert_eq!(found.status, ToiStatus::Contact, "{overlap}: {found:?}");
        let touching = -1.0 + 2.0 * found.upper;
        let floor = ToiOptions {
            initial_contact: InitialContact::Deepen { by: 1.0e-4 },
            cores: Some(Cores {
                share: 0.5,
                at_most: Real::INFINITY,
                tips: 0.0,
            }),
            ..options
        };
        let on = slides(touching, 2.0);
        let found = first_contact(&up, &still, &down, &on, 1.0, &floor);
        let crossing = -0.5 * touching;
        assert_eq!(found.status, ToiStatus::Contact, "{overlap}: {found:?}");
        assert!(found.lower < crossing, "{overlap}: {found:?}, {crossing}");
    }
}
