//! Meshes against meshes: the search over two trees against brute force over all primitive pairs, by
//! the elementary queries that the oracle judges.

use crate::ccd::rng::Rng;
use crate::detailed::{Form, detailed};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::distance::signed_distance;
use rapier3d_medial::elementary::test_list::OwnedFeatures;
use rapier3d_medial::elementary::{
    self, MovingSphere, Paths, ToiOptions, ToiStatus, f64 as double,
};
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::medial::tree::NodeKind;
use rapier3d_medial::pair::{PrimitiveTree, contacts, first_contact, nearest_spheres};
use rapier3d_medial::{MedialMesh, MedialSphere};

pub(crate) fn vector(rng: &mut Rng) -> Vector {
    Vector::from([0; 3].map(|_| rng.range(-1.0, 1.0) as Real))
}

/// Slabs in a fan, a chain of cones, and a lone sphere.
pub(crate) fn mesh(rng: &mut Rng) -> MedialMesh {
    let mut spheres = Vec::new();
    for k in 0..14 {
        let spread = if k < 7 { 0.4 } else { 0.8 };
        let radius = rng.range(0.01, 0.12) as Real;
        spheres.push(MedialSphere::new(vector(rng) * spread, radius));
    }
    let faces = (1..6).map(|k| [0, k, k + 1]).collect();
    let edges = (6..12).map(|k| [k, k + 1]).collect();
    MedialMesh::new(spheres, edges, faces).expect("a medial mesh")
}

pub(crate) fn motion(
    rng: &mut Rng,
    distance: Real,
    speed: Real,
    spin: Real,
) -> NonlinearRigidMotion {
    let away = vector(rng).normalize_or_zero() * distance;
    let towards = vector(rng) * 0.4 - away.normalize_or_zero();
    let start = Pose::new(away, vector(rng) * 3.0);
    let center = vector(rng) * 0.2;
    NonlinearRigidMotion::new(start, center, towards * speed, vector(rng) * spin)
}

/// Earliest of all primitive pairs, and whether any overlaps at the start.
fn brute_force(
    meshes: [&MedialMesh; 2],
    motions: [&NonlinearRigidMotion; 2],
    options: &double::ToiOptions,
) -> (f64, bool) {
    let (mut first, mut overlaps) = (1.0, false);
    for p in meshes[0].primitives() {
        for q in meshes[1].primitives() {
            let (p, q) = (p.spheres(), q.spheres());
            let toi = double::first_contact_rigid(p, motions[0], q, motions[1], 1.0, options);
            assert_ne!(toi.status, ToiStatus::Unresolved);
            overlaps |= toi.status == ToiStatus::Overlapping;
            first = f64::min(first, toi.upper);
        }
    }
    (first, overlaps)
}

/// Slow and fast, in contact early, late and never; kept apart and let sink in.
#[test]
fn first_contact_is_that_of_brute_force() {
    let mut rng = Rng::new(77);
    let mut counts = [0; 3];
    for k in 0..300 {
        let (a, b) = (mesh(&mut rng), mesh(&mut rng));
        let still = motion(&mut rng, 0.0, 0.0, (k % 4) as Real);
        let moving = motion(&mut rng, 0.6 + (k % 7) as Real * 0.4, 2.0, (k % 5) as Real);
        let target = [0.0, 0.0, 0.05, -0.05][k % 4];
        let options = ToiOptions {
            tolerance: 1.0e-7,
            target_distance: target,
            ..Default::default()
        };
        let exact = double::ToiOptions {
            target_distance: target.into(),
            tolerance: options.tolerance.into(),
            time_tolerance: options.time_tolerance.into(),
            ..Default::default()
        };
        let toi = first_contact(&a, &still, &b, &moving, 1.0, &options);
        let (first, overlaps) = brute_force([&a, &b], [&still, &moving], &exact);
        let found = match toi.status {
            ToiStatus::Separated => 1.0,
            _ => f64::from(toi.upper),
        };
        // Both brackets are this wide, and each ends where the distance is between the tolerance and
        // 0: later by the tolerance over the speed of approach, here above 0.02 a step.
        let close = 2.0 * f64::from(options.time_tolerance) + 50.0 * f64::from(options.tolerance);
        assert!((found - first).abs() <= close, "{k}: {toi:?}, not {first}");
        assert_eq!(
            toi.status == ToiStatus::Overlapping,
            overlaps,
            "{k}: {toi:?}"
        );
        counts[match toi.status {
            ToiStatus::Separated => 0,
            ToiStatus::Contact => 1,
            _ => 2,
        }] += 1;
    }
    assert!(counts.iter().all(|&n| n > 30), "{counts:?}");
}

/// Distance and contacts at a fixed pose.
#[test]
fn distance_and_contacts_are_those_of_brute_force() {
    let mut rng = Rng::new(78);
    let (mut near, mut found_any) = (0, 0);
    for k in 0..300 {
        let (a, b) = (mesh(&mut rng), mesh(&mut rng));
        let pose = Pose::new(
            vector(&mut rng) * (0.3 + 0.004 * k as Real),
            vector(&mut rng) * 3.0,
        );
        let balls = |m: &MedialMesh, pose: &Pose| -> Vec<Vec<(Vec3<f64>, f64)>> {
            let place =
                |s: &MedialSphere| (Vec3::from_vector(*pose * s.center), f64::from(s.radius));
            m.primitives()
                .map(|p| p.spheres().iter().map(place).collect())
                .collect()
        };
        let (pa, pb) = (balls(&a, &Pose::IDENTITY), balls(&b, &pose));
        // Positions rounded to f32 here, not there: a few ulps of what is below 4.
        let close = 16.0 * f64::from(f32::EPSILON);
        let margin = 0.1;
        let (all, _) = contacts(&a, &b, &pose, margin);
        let mut least = f64::MAX;
        for (i, p) in pa.iter().enumerate() {
            for (j, q) in pb.iter().enumerate() {
                let distance = signed_distance(p, q);
                least = least.min(distance);
                // What an owner reports stands for its neighbours: some contact is as near.
                if distance < f64::from(margin) - close {
                    let nearest = all.iter().map(|c| f64::from(c.distance));
                    let nearest = nearest.fold(f64::MAX, f64::min);
                    assert!(
                        nearest <= distance + close,
                        "{k}: {i} {j} {nearest} {distance}"
                    );
                    near += 1;
                }
            }
        }
        found_any += usize::from(!all.is_empty());
        let nearest = nearest_spheres(&a, &b, &pose, Real::MAX)
            .0
            .expect("a nearest pair");
        // Where slabs cross, the nearest is the penetration depth, at least as deep.
        assert!(
            f64::from(nearest.distance) <= least + close,
            "{k}: {nearest:?}, not {least}"
        );
        if least > 0.0 {
            assert!((f64::from(nearest.distance) - least).abs() <= close);
            let [p, q] = nearest.points;
            let gap = f64::from((pose * q - p).length());
            assert!(
                (gap - least).abs() <= close,
                "{k}: points {gap} apart, not {least}"
            );
        }
    }
    assert!(near > 1000 && found_any > 100, "{near} {found_any}");
}

/// A mesh of which no directions are tried before the search.
struct Bare<'a>(&'a MedialMesh);

impl PrimitiveTree for Bare<'_> {
    fn roots(&self) -> u32 {
        self.0.roots()
    }
    fn bound(&self, node: u32) -> (Vector, Real) {
        self.0.bound(node)
    }
    fn kind(&self, node: u32) -> NodeKind {
        self.0.kind(node)
    }
    fn primitive(&self, index: u32) -> ([MedialSphere; 3], OwnedFeatures) {
        PrimitiveTree::primitive(self.0, index)
    }
}

/// What directions keep apart is left out of the search, and nothing else: the contacts are those of the whole
/// search, to the bit.
#[test]
fn directions_leave_out_no_contact() {
    let mut rng = Rng::new(79);
    let (mut nodes, mut all_nodes, mut near) = (0, 0, 0);
    for k in 0..2000 {
        let (a, b) = (mesh(&mut rng), mesh(&mut rng));
        let pose = Pose::new(
            vector(&mut rng) * (0.3 + 0.001 * k as Real),
            vector(&mut rng) * 3.0,
        );
        let margin = [0.0, 0.005, 0.02, 0.1][k % 4];
        let (found, counts) = contacts(&a, &b, &pose, margin);
        let (whole, all) = contacts(&Bare(&a), &Bare(&b), &pose, margin);
        assert_eq!(found, whole, "{k}");
        nodes += counts.nodes;
        all_nodes += all.nodes;
        near += usize::from(!found.is_empty());
    }
    assert!((500..1500).contains(&near), "{near}");
    assert!(4 * nodes < 3 * all_nodes, "{nodes} of {all_nodes}");
}

/// Bodies within the tolerance of each other at the start touch at time 0, however their bounding balls
/// lie; those further apart do later. Casts that may slide ask for this. Planted gaps.
#[test]
fn within_the_tolerance_at_the_start_is_contact_at_once() {
    let centers = [Vector::ZERO, Vector::Y, Vector::Z];
    let body = |n: usize| {
        let spheres = centers[..n].iter().map(|c| MedialSphere::new(*c, 0.25));
        let (edges, faces) = match n {
            2 => (vec![[0, 1]], vec![]),
            3 => (vec![], vec![[0, 1, 2]]),
            _ => (vec![], vec![]),
        };
        MedialMesh::new(spheres.collect(), edges, faces).expect("a medial mesh")
    };
    let options = ToiOptions::default();
    let still = NonlinearRigidMotion::identity();
    for (n, m) in [(1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3)] {
        for gap in [0.5, 2.0, 100.0].map(|k| k * options.tolerance) {
            let mut moving = NonlinearRigidMotion::identity();
            moving.start = Pose::translation(0.5 + gap, 0.0, 0.0);
            moving.linvel = -Vector::X;
            let toi = first_contact(&body(n), &still, &body(m), &moving, 1.0, &options);
            // Two ulps of a coordinate of 0.5, in time at speed 1.
            let close = 2.0 * 0.5 * Real::EPSILON;
            let (earliest, latest) = match gap > options.tolerance {
                true => (gap - options.tolerance - close, gap + close),
                false => (0.0, 0.0),
            };
            assert_eq!(toi.status, ToiStatus::Contact, "{n} {m} {gap}: {toi:?}");
            assert!(
                earliest <= toi.upper && toi.upper <= latest,
                "{n} {m} {gap}: {toi:?}"
            );
        }
    }
}

/// On straight paths: each sphere of both meshes from where the rigid motion starts it to where it ends,
/// all primitive pairs by the elementary query. Fast spins, so that these are not the rigid paths.
#[test]
fn first_contact_on_straight_paths_is_that_of_brute_force() {
    let mut rng = Rng::new(78);
    let (mut hits, mut others) = (0, 0);
    for k in 0..200 {
        let meshes = [mesh(&mut rng), mesh(&mut rng)];
        let motions = [
            motion(&mut rng, 0.0, 0.0, 1.0 + (k % 3) as Real),
            motion(&mut rng, 2.0 + (k % 5) as Real * 0.3, 2.0, (k % 4) as Real),
        ];
        let options = |paths| ToiOptions {
            tolerance: 1.0e-5,
            paths,
            ..Default::default()
        };
        let movers = [0, 1].map(|side| {
            let [start, end] = [0.0, 1.0].map(|t| motions[side].position_at_time(t));
            let mover = |s: &MedialSphere| {
                let center = start * s.center;
                MovingSphere {
                    center,
                    radius: s.radius,
                    displacement: end * s.center - center,
                }
            };
            let primitives = meshes[side].primitives();
            primitives
                .map(|p| p.spheres().iter().map(mover).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        });
        let mut first: Real = 1.0;
        for p in &movers[0] {
            for q in &movers[1] {
                let toi = elementary::first_contact(p, q, &options(Paths::Exact));
                first = first.min(toi.upper);
            }
        }
        let query = |paths| {
            let [m1, m2] = &motions;
            first_contact(&meshes[0], m1, &meshes[1], m2, 1.0, &options(paths))
        };
        let straight = query(Paths::Straight);
        assert!(
            straight.lower - 1.0e-4 <= first && first <= straight.upper + 1.0e-4,
            "case {k}: {first}, {straight:?}"
        );
        hits += u32::from(first < 1.0);
        others += u32::from((query(Paths::Exact).upper - first).abs() > 1.0e-3);
    }
    assert!(
        hits >= 60 && others >= 30,
        "{hits} hits, {others} off the rigid paths"
    );
}

/// A hull holds a sphere if it reaches as far along every direction: judged in double precision along many.
#[test]
fn hulls_hold_what_is_below_their_nodes() {
    let mut rng = Rng::new(83);
    let (mut looked, mut touched) = (0, 0);
    for form in [Form::Ring, Form::Spider, Form::Bear, Form::Sheet] {
        for mesh in [detailed(form, 40), mesh(&mut rng)] {
            let below = |node: u32| {
                let (mut all, mut stack) = (Vec::new(), vec![node]);
                while let Some(node) = stack.pop() {
                    match mesh.kind(node) {
                        NodeKind::Primitive(p) => all.extend(PrimitiveTree::primitive(&mesh, p).0),
                        NodeKind::Nodes(a, b) => stack.extend([a, b]),
                    }
                }
                all
            };
            for node in 0..mesh.tree().nodes().len() as u32 {
                let (spheres, len) = mesh.hull(node);
                let held = below(node);
                for _ in 0..60 {
                    let n = Vec3::<f64>::from_vector(vector(&mut rng));
                    let n = n * (1.0 / n.length());
                    let reach = |s: &[MedialSphere]| {
                        let of = |s: &MedialSphere| {
                            n.dot(Vec3::from_vector(s.center)) + f64::from(s.radius)
                        };
                        s.iter().map(of).fold(f64::MIN, f64::max)
                    };
                    let room = reach(&spheres[..len]) - reach(&held);
                    // Both are sums of a few numbers below 2.
                    assert!(room > -1.0e-15, "{form:?}, node {node}: {room}");
                    looked += 1;
                    touched += usize::from(room < 1.0e-3);
                }
            }
        }
    }
    assert!(
        10 * touched > looked,
        "{touched} of {looked} fit within a millimetre"
    );
}
