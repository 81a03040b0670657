//! Parts that touch at the start and go on into each other, as thin as they come: before their axes cross, the
//! query says so. Two straight axes that only slide cross at a moment that a closed form tells.

use crate::ccd::rng::Rng;
use crate::meshes::vector;
use rapier3d::glamx::DVec3;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::{Cores, InitialContact, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Real, Vector};
use rapier3d_medial::pair::first_contact;
use rapier3d_medial::{MedialMesh, MedialSphere};

/// Queries of each kind: 2,000, or as many as `DEEPENING` says.
fn queries() -> u32 {
    let asked = std::env::var("DEEPENING").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(2000)
}

fn rod(ends: [Vector; 2], radii: [Real; 2]) -> MedialMesh {
    let spheres = [0, 1].map(|k| MedialSphere::new(ends[k], radii[k]));
    MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a rod")
}

/// When the axis of the second, which slides by `slide` in the step, crosses that of the first.
fn crossing(p: [Vector; 2], q: [Vector; 2], slide: Vector) -> Option<f64> {
    let [p0, p1, q0, q1] = [p[0], p[1], q[0], q[1]].map(|v| v.as_dvec3());
    let (u, v, w) = (p1 - p0, q1 - q0, slide.as_dvec3());
    let across = u.cross(v);
    let time = -(q0 - p0).dot(across) / w.dot(across);
    let y: DVec3 = q0 + w * time - p0;
    let square = across.length_squared();
    let (s, t) = (
        y.cross(v).dot(across) / square,
        y.cross(u).dot(across) / square,
    );
    let inside = [s, t].iter().all(|x| (0.0..=1.0).contains(x));
    (inside && (0.0..=1.0).contains(&time)).then_some(time)
}

/// The axes of two rods that cross each other, seen along the line across both, and the way on which the
/// second goes through the first.
struct Crossing {
    ends: [[Vector; 2]; 2],
    slide: Vector,
}

fn crossing_rods(rng: &mut Rng, gap: Real, way: Real) -> Crossing {
    let (u, aside) = (vector(rng).normalize(), vector(rng));
    let n = u.cross(aside).normalize();
    let v = (n.cross(u) + u * rng.range(-0.9, 0.9) as Real).normalize();
    let at = vector(rng);
    let along = |d: Vector, from: Vector| [from - d * 0.7, from + d * 0.9];
    Crossing {
        ends: [along(u, at), along(v, at + n * gap)],
        slide: n * -way + (u + v) * 0.1 * way,
    }
}

fn asked(rods: &Crossing, radii: [[Real; 2]; 2], options: &ToiOptions) -> (ToiStatus, Real) {
    let meshes = [0, 1].map(|k| rod(rods.ends[k], radii[k]));
    let still = NonlinearRigidMotion::identity();
    let moving = NonlinearRigidMotion {
        linvel: rods.slide,
        ..still
    };
    let toi = first_contact(&meshes[0], &still, &meshes[1], &moving, 1.0, options);
    (toi.status, toi.lower)
}

/// Whatever the rods may deepen by, many times their thickness or little, and whether they touch by a hair or
/// are deep in each other.
#[test]
fn touching_bodies_never_cross_unseen() {
    let mut rng = Rng::new(7);
    let mut crossed = 0;
    for case in 0..queries() {
        let radius = 10.0_f64.powf(rng.range(-4.5, -1.0)) as Real;
        let blunt = [radius * rng.range(0.0, 1.0) as Real, radius];
        let radii = if case % 3 == 0 {
            [blunt; 2]
        } else {
            [[radius; 2]; 2]
        };
        let gap = radius * rng.range(0.02, 1.9) as Real;
        let rods = crossing_rods(&mut rng, gap, way(case, radius));
        let cores = (case % 2 == 0).then_some(Cores {
            share: 0.5,
            at_most: Real::INFINITY,
            tips: 0.0,
        });
        let options = ToiOptions {
            tolerance: 1.0e-5,
            cores,
            initial_contact: InitialContact::Deepen {
                by: radius * 10.0_f64.powf(rng.range(-2.0, 2.0)) as Real,
            },
            ..ToiOptions::default()
        };
        let Some(time) = crossing(rods.ends[0], rods.ends[1], rods.slide) else {
            continue;
        };
        crossed += 1;
        let (status, lower) = asked(&rods, radii, &options);
        let seen = status == ToiStatus::Contact && f64::from(lower) < time;
        assert!(
            seen,
            "case {case}: {status:?} at {lower}, crossing at {time}"
        );
    }
    assert!(crossed > queries() / 2, "only {crossed} cross");
}

/// Ways of 4 to 1,000 times the radius: the axes start at most 1.9 apart.
fn way(case: u32, radius: Real) -> Real {
    radius * [4.0, 30.0, 1000.0][case as usize % 3]
}

/// Cores of rods of one radius each meet where the rods are half as deep in each other as the thinner is
/// thick.
#[test]
fn cores_meet_at_their_share_of_the_local_thickness() {
    let mut rng = Rng::new(8);
    for case in 0..queries() / 4 {
        let radii = [0, 1].map(|_| 10.0_f64.powf(rng.range(-2.0, -0.5)) as Real);
        let (sum, thinner) = (radii[0] + radii[1], radii[0].min(radii[1]));
        let rods = crossing_rods(&mut rng, sum + 0.3, 1.0);
        let options = ToiOptions {
            cores: Some(Cores {
                share: 0.5,
                at_most: Real::INFINITY,
                tips: 0.0,
            }),
            ..ToiOptions::default()
        };
        let (status, lower) = asked(&rods, radii.map(|r| [r; 2]), &options);
        let depth = sum - (sum + 0.3) + lower;
        assert_eq!(status, ToiStatus::Contact, "case {case}");
        assert!(
            (depth - 0.5 * thinner).abs() < 1.0e-3,
            "case {case}: {depth}"
        );
    }
}

/// Sheets of radius 0 that start nearer to each other than the target distance: a contact, or a safe lower bound where
/// what they may still come nearer is less than the kernel resolves.
#[test]
fn sheets_of_radius_0_never_cross_unseen() {
    let sheet = |y: Real| {
        let corner = |x, z| MedialSphere::new(Vector::new(x, y, z), 0.0);
        let spheres = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)];
        MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).expect("a sheet")
    };
    let still = NonlinearRigidMotion::identity();
    let mut rng = Rng::new(9);
    let mut unresolved = 0;
    for case in 0..queries() / 4 {
        let gap = 10.0_f64.powf(rng.range(-6.0, -3.0)) as Real;
        let moving = NonlinearRigidMotion {
            linvel: Vector::new(0.1, -1.0, 0.0),
            angvel: vector(&mut rng) * 1.0e-5 * gap,
            ..still
        };
        let options = ToiOptions {
            target_distance: 1.0e-3,
            tolerance: 1.0e-5,
            initial_contact: InitialContact::Deepen {
                by: rng.range(1.0e-6, 0.1) as Real,
            },
            ..ToiOptions::default()
        };
        let toi = first_contact(&sheet(0.0), &still, &sheet(gap), &moving, 1.0, &options);
        let seen = toi.status != ToiStatus::Separated && toi.lower < gap;
        unresolved += u32::from(toi.status == ToiStatus::Unresolved);
        assert!(
            seen,
            "case {case}: {:?} at {}, crossing at {gap}",
            toi.status, toi.lower
        );
    }
    assert!(unresolved < queries() / 20, "{unresolved} unresolved");
}

/// Blunt rods, thick at one end and nearly without radius at the other, whose thick ends are a hair apart, or in each
/// other by one: they may sink in by all of what is asked, and no further.
#[test]
fn blunt_rods_that_touch_sink_in_by_what_is_asked() {
    let mut rng = Rng::new(10);
    let still = NonlinearRigidMotion::identity();
    for case in 0..queries() / 4 {
        let thick = rng.range(0.05, 0.2) as Real;
        let by = thick * rng.range(0.02, 0.05) as Real;
        let gap = by * rng.range(-0.9, 0.9) as Real;
        let radii = [thick, thick * 1.0e-3];
        let y = 2.0 * thick + gap;
        let lower = rod([Vector::ZERO, Vector::new(1.0, 0.0, 0.0)], radii);
        let upper = rod([Vector::new(0.0, y, 0.0), Vector::new(-1.0, y, 0.0)], radii);
        let options = ToiOptions {
            target_distance: by,
            tolerance: 0.02 * by,
            initial_contact: InitialContact::Deepen { by },
            ..ToiOptions::default()
        };
        for (sinks, status) in [
            (0.0, ToiStatus::Separated),
            (0.9, ToiStatus::Separated),
            (1.2, ToiStatus::Contact),
        ] {
            let moving = NonlinearRigidMotion {
                linvel: Vector::new(0.1 * by, -sinks * by, 0.1 * by),
                ..still
            };
            let toi = first_contact(&lower, &still, &upper, &moving, 1.0, &options);
            assert_eq!(toi.status, status, "case {case}: {gap} apart, {sinks}");
        }
    }
}
