//! Endless turns: a propeller that comes down on a floor while it turns 10 to 10³⁰ radians. Exact as long as
//! the work allows, then unresolved and never late; and the work is bounded. Counts, not times.

use parry3d::math::{Pose, Real, Vector};
use parry3d::query::NonlinearRigidMotion;
use parry3d::shape::SharedShape;
use rapier3d_medial::elementary::{Toi, ToiStatus};
use rapier3d_medial::pair::first_contact::Counts;
use rapier3d_medial::parry::queries::cast::Cast;
use rapier3d_medial::parry::queries::initial_contacts::AtStart;
use rapier3d_medial::{MedialMesh, MedialSphere, ToiOptions};

const HALF_LENGTH: f64 = 0.75;
const RADIUS: f64 = 0.125;
const HEIGHT: f64 = 2.0;
const SPEED: f64 = 1.75;

/// Counts of a query are below this, whatever it turns.
const MOST: u64 = 1_500_000;

fn propeller() -> MedialMesh {
    let tip = |side: f64| {
        let center = Vector::X * (side * HALF_LENGTH) as Real;
        MedialSphere::new(center, RADIUS as Real)
    };
    MedialMesh::new(vec![tip(-1.0), tip(1.0)], vec![[0, 1]], vec![]).expect("a bar")
}

/// Both with their top at the height 0: 50 triangles, and a cylinder.
fn floors() -> [(&'static str, SharedShape, Vector); 2] {
    let at = |i: u32, j: u32| Vector::new(i as Real - 2.5, 0.0, j as Real - 2.5);
    let vertices = (0..36).map(|k| at(k % 6, k / 6)).collect();
    let cells = (0..25).map(|k| k % 5 + 6 * (k / 5));
    let cells = cells.flat_map(|c| [[c, c + 6, c + 1], [c + 1, c + 6, c + 7]]);
    let mesh = SharedShape::trimesh(vertices, cells.collect()).expect("a floor");
    [
        ("triangles", mesh, Vector::ZERO),
        (
            "cylinder",
            SharedShape::cylinder(0.5, 2.0),
            Vector::Y * -0.5,
        ),
    ]
}

fn cast(floor: &SharedShape, at: Vector, turn: Real) -> (Toi, Counts) {
    let mesh = propeller();
    let cast = Cast {
        motion1: &NonlinearRigidMotion::new(
            Pose::from_translation(Vector::Y * HEIGHT as Real),
            Vector::ZERO,
            Vector::Y * -SPEED as Real,
            Vector::Z * turn,
        ),
        mesh: &mesh,
        motion2: &NonlinearRigidMotion::constant_position(Pose::from_translation(at)),
        other: &**floor,
        times: [0.0, 1.0],
        target_distance: 0.0,
        at_start: AtStart::Stop,
        stop_approach: true,
    };
    let found = cast.toi(&ToiOptions::default(), None);
    let found = found.expect("rapier's own shape");
    (found.toi, found.counts)
}

/// Height of the lower tip's sphere over the floor.
fn height(turn: f64, t: f64) -> f64 {
    HEIGHT - SPEED * t - HALF_LENGTH * (turn * t).sin().abs() - RADIUS
}

/// The first time at which the lower tip is on the floor: by dense samples from the moment on at which it
/// could be, 400 to a half turn, and halving.
fn planted(turn: f64) -> f64 {
    let earliest = (HEIGHT - RADIUS - HALF_LENGTH) / SPEED;
    let step = (std::f64::consts::PI / turn / 400.0).min(1.0e-4);
    let mut before = earliest;
    while height(turn, before + step) > 0.0 {
        before += step;
    }
    let mut after = before + step;
    for _ in 0..60 {
        let middle = 0.5 * (before + after);
        if height(turn, middle) > 0.0 {
            before = middle;
        } else {
            after = middle;
        }
    }
    after
}

#[test]
fn any_number_of_turns_ends_and_is_never_late() {
    for (name, floor, at) in floors() {
        for turn in [
            10.0, 100.0, 1.0e3, 1.0e4, 1.0e5, 1.0e6, 1.0e9, 1.0e18, 1.0e30,
        ] {
            let (toi, counts) = cast(&floor, at, turn);
            let (turn, lower) = (f64::from(turn), f64::from(toi.lower));
            let first = planted(turn.min(1.0e6));
            let said = || format!("{name}, {turn:e}: {toi:?}, {counts:?}, planted {first}");
            assert!(
                counts.nodes + counts.tests + u64::from(toi.iterations) < MOST,
                "{}",
                said()
            );
            assert_ne!(toi.status, ToiStatus::Separated, "{}", said());
            assert!(
                lower <= first && f64::from(toi.upper) >= first - 1.0e-4,
                "{}",
                said()
            );
            // What `f32` resolves of the time, the tip swings that far.
            let resolved = turn * HALF_LENGTH * f64::from(Real::EPSILON);
            if turn <= 1.0e4 {
                assert_eq!(toi.status, ToiStatus::Contact, "{}", said());
                assert!(height(turn, lower) < 2.0e-4 + resolved, "{}", said());
            } else if toi.status == ToiStatus::Unresolved {
                assert!(lower > 0.0 && toi.points[0].is_finite(), "{}", said());
            }
        }
    }
}
