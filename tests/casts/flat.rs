//! Contacts with flat faces: by the signed distance of spheres to planes and boxes, in `f64`.

use crate::rng::Rng;
use rapier3d::parry::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use rapier3d::parry::shape::{Cuboid, HalfSpace, Shape};
use rapier3d_medial::math::{Pose, Real, Rotation, Vector};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

type Manifold = ContactManifold<(), ()>;

const PREDICTION: Real = 0.02;

/// What `f32` loses in poses 10 m from the origin.
const SLACK: f64 = 1.0e-5;

/// A contact: both points, and the normal out of the mesh, in the other's frame, and the gap.
struct Found {
    points: [Vector; 2],
    normal: Vector,
    gap: Real,
}

/// Contacts of `mesh` at `pose` in the frame of `other`, with the mesh first or second.
fn contacts(mesh: &MedialMesh, pose: &Pose, other: &dyn Shape, flipped: bool) -> Vec<Found> {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mut manifolds: Vec<Manifold> = Vec::new();
    let mut workspace = None;
    let (all, pos12): ([&dyn Shape; 2], Pose) = if flipped {
        ([other, mesh], *pose)
    } else {
        ([mesh, other], pose.inverse())
    };
    let [first, second] = all;
    dispatcher
        .contact_manifolds(
            &pos12,
            first,
            second,
            PREDICTION,
            &mut manifolds,
            &mut workspace,
        )
        .expect("supported");
    let of = |m: &Manifold| {
        // Parts of parry have their own frames.
        let local =
            [m.subshape_pos1(), m.subshape_pos2()].map(|p| p.copied().unwrap_or(Pose::IDENTITY));
        let normals = [
            local[0].rotation * m.local_n1,
            local[1].rotation * m.local_n2,
        ];
        let of = |p: &rapier3d::parry::query::TrackedContact<()>| {
            let [p1, p2] = [local[0] * p.local_p1, local[1] * p.local_p2];
            let (of_mesh, of_other, normal) = if flipped {
                (p2, p1, -normals[0])
            } else {
                (p1, p2, -normals[1])
            };
            Found {
                points: [*pose * of_mesh, of_other],
                normal,
                gap: p.dist,
            }
        };
        m.points.iter().map(of).collect::<Vec<_>>()
    };
    manifolds.iter().flat_map(of).collect()
}

fn vector(v: nalgebra::Vector3<f64>) -> Vector {
    Vector::new(v.x as Real, v.y as Real, v.z as Real)
}

fn rotation(rng: &mut Rng) -> Rotation {
    Rotation::from_scaled_axis(vector(rng.in_ball() * 3.0))
}

/// A body of slabs and cones of any radii.
fn body(rng: &mut Rng) -> MedialMesh {
    let sphere = |_| MedialSphere::new(vector(rng.in_ball()), rng.range(0.05, 0.3) as Real);
    let spheres: Vec<MedialSphere> = (0..6).map(sphere).collect();
    MedialMesh::new(spheres, vec![[3, 4], [2, 5]], vec![[0, 1, 2]]).expect("valid")
}

/// Height of the lowest sphere above a plane through the origin, by `f64`.
fn lowest(mesh: &MedialMesh, pose: &Pose, normal: Vector, height: f64) -> f64 {
    let wide = |v: Vector| nalgebra::Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z));
    let heights = mesh.spheres().iter().map(|s| {
        let center = wide(*pose * s.center);
        center.dot(&wide(normal)) - height - f64::from(s.radius)
    });
    heights.fold(f64::MAX, f64::min)
}

#[test]
fn the_deepest_contact_with_a_face_is_that_of_the_deepest_sphere() {
    let mut rng = Rng::new(31);
    // Few, for the mass of a body is measured at its first contact.
    let bodies: Vec<MedialMesh> = (0..20).map(|_| body(&mut rng)).collect();
    let [mut touching, mut free] = [0, 0];
    for case in 0..2_000 {
        let mesh = &bodies[rng.below(bodies.len())];
        let turn = rotation(&mut rng);
        let normal = vector(rng.in_ball().normalize());
        let axis = rng.below(3);
        let side = rng.sign() as Real;
        let half = vector(nalgebra::Vector3::from_fn(|_, _| rng.range(6.0, 9.0)));
        let (other, normal, height): (Box<dyn Shape>, Vector, Real) = if case % 2 == 0 {
            (Box::new(HalfSpace::new(normal)), normal, 0.0)
        } else {
            let mut normal = Vector::ZERO;
            normal[axis] = side;
            (Box::new(Cuboid::new(half)), normal, half[axis])
        };
        let [u, v] = normal.any_orthonormal_pair().into();
        let aside = u * rng.range(-2.0, 2.0) as Real + v * rng.range(-2.0, 2.0) as Real;
        let upright = Pose::from_parts(aside, turn);
        // The lowest sphere somewhere between 0.3 below and 0.05 above the plane.
        let gap = rng.range(-0.3, 0.05);
        let up = gap - lowest(mesh, &upright, normal, f64::from(height));
        let pose = Pose::from_parts(aside + normal * up as Real, turn);
        let truth = lowest(mesh, &pose, normal, f64::from(height));
        for flipped in [false, true] {
            let found = contacts(mesh, &pose, other.as_ref(), flipped);
            if truth > f64::from(PREDICTION) {
                free += 1;
                assert!(found.is_empty(), "{case}");
                continue;
            }
            touching += 1;
            assert!((1..=4).contains(&found.len()), "{case}: {}", found.len());
            let least = found.iter().map(|c| c.gap).fold(Real::MAX, Real::min);
            assert!(
                (f64::from(least) - truth).abs() < SLACK,
                "{case}: {least} {truth}"
            );
            for c in &found {
                assert!(c.normal.distance(-normal) < 1.0e-6, "{case}");
                let [p, q] = c.points;
                assert!(
                    (q.dot(normal) - height).abs() < SLACK as Real,
                    "{case}: off the plane"
                );
                assert!(
                    (p + c.normal * c.gap).distance(q) < SLACK as Real,
                    "{case}: not along the normal"
                );
                let sphere = |s: &&MedialSphere| {
                    ((pose * s.center).distance(p) - s.radius).abs() < SLACK as Real
                };
                assert!(
                    mesh.spheres().iter().any(|s| sphere(&s)),
                    "{case}: off the spheres"
                );
            }
        }
    }
    assert!(touching > 3_000 && free > 300, "{touching} {free}");
}

/// Whether a face, an edge or a corner is nearest: signed distance of a box.
#[test]
fn balls_all_round_a_box_have_its_distance() {
    let mut rng = Rng::new(32);
    let radii: [Real; 3] = [0.05, 0.12, 0.3];
    let balls = radii.map(|radius| MedialMesh::ball(radius).expect("a ball"));
    let [mut faces, mut edges] = [0, 0];
    for case in 0..6_000 {
        let half = vector(nalgebra::Vector3::from_fn(|_, _| rng.range(0.2, 1.5)));
        let size = rng.below(radii.len());
        let (radius, mesh) = (radii[size], &balls[size]);
        let unit = nalgebra::Vector3::from_fn(|_, _| rng.range(-1.3, 1.3));
        let center = half * vector(unit);
        let out = center.abs() - half;
        let beside = out.max(Vector::ZERO).length();
        let truth = beside + out.max_element().min(0.0) - radius;
        // Deeper, parry's way out of parts is not the shortest.
        if truth > PREDICTION || beside == 0.0 {
            continue;
        }
        let pose = Pose::from_parts(center, rotation(&mut rng));
        for flipped in [false, true] {
            let found = contacts(mesh, &pose, &Cuboid::new(half), flipped);
            let least = found.iter().map(|c| c.gap).fold(Real::MAX, Real::min);
            assert!(
                (least - truth).abs() < 1.0e-3 * radius,
                "{case}: {least} {truth}"
            );
        }
        let over = (0..3).filter(|k| out[*k] > 0.0).count();
        *if over == 1 { &mut faces } else { &mut edges } += 1;
    }
    assert!(faces > 400 && edges > 200, "{faces} {edges}");
}

/// Contacts go on when a body slides from the middle of a face to its edge, where parry takes over, and
/// back, whoever made the list before.
#[test]
fn contacts_go_on_while_a_body_slides_over_an_edge_and_back() {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mesh = MedialMesh::torus(0.4, 0.1, 27).expect("a ring");
    let table = Cuboid::new(Vector::new(1.0, 0.5, 1.0));
    let mut manifolds: Vec<Manifold> = Vec::new();
    let mut workspace = None;
    for step in 0..400 {
        let x = 1.2 * (step as Real * 0.05).sin();
        let pose = Pose::translation(x, 0.5 + 0.1 - 0.001, 0.0);
        let look = |manifolds: &mut Vec<Manifold>, workspace: &mut Option<_>| {
            dispatcher
                .contact_manifolds(
                    &pose.inverse(),
                    &mesh,
                    &table,
                    PREDICTION,
                    manifolds,
                    workspace,
                )
                .expect("supported");
        };
        look(&mut manifolds, &mut workspace);
        let mut fresh = Vec::new();
        look(&mut fresh, &mut None);
        let points = |all: &[Manifold]| all.iter().map(|m| m.points.len()).sum::<usize>();
        let deepest = |all: &[Manifold]| {
            let all = all.iter().flat_map(|m| &m.points);
            all.map(|p| p.dist).fold(Real::MAX, Real::min)
        };
        assert!(points(&manifolds) >= 2, "{x}: {}", points(&manifolds));
        assert!((deepest(&manifolds) + 0.001).abs() < 1.0e-4, "{x}");
        assert!(
            (deepest(&manifolds) - deepest(&fresh)).abs() < 1.0e-4,
            "{x}"
        );
    }
}

/// parry may not know the features of the only contact at an edge. That list is parry's none the less, with
/// a workspace that goes with it: a body that jumps off and comes back does not make parry look for its
/// contact in another list.
#[test]
fn a_contact_without_features_is_parrys() {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let table = Cuboid::new(Vector::new(1.0, 0.5, 1.0));
    let ends = [
        [0.06378889, -0.013965415, -0.18997534],
        [0.020026317, -0.004630943, -0.052498754],
        [0.19712125, 0.0011196756, -0.0035055724],
    ];
    let spheres = ends.map(|c| MedialSphere::new(Vector::from(c), 0.05));
    let mesh = MedialMesh::new(spheres.to_vec(), vec![], vec![[0, 1, 2]]).expect("a slab");
    let mut edge = Pose::translation(0.97533756, 0.5044995, 0.6097179);
    edge.rotation = Rotation::from_xyzw(-0.07045055, -0.35603732, 0.32725692, 0.87245464);
    let above = Pose::translation(0.0, 0.8, 0.0);
    let (mut manifolds, mut workspace) = (Vec::<Manifold>::new(), None);
    let mut firsts = Vec::new();
    for pose in [edge, above, edge] {
        let lists = (&mut manifolds, &mut workspace);
        dispatcher
            .contact_manifolds(&pose.inverse(), &mesh, &table, PREDICTION, lists.0, lists.1)
            .expect("supported");
        let first = manifolds.first().and_then(|m| m.points.first());
        firsts.push(first.map(|p| (p.fid1.is_unknown() || p.fid2.is_unknown(), p.dist)));
    }
    assert!(firsts[0].is_some_and(|(unknown, _)| unknown), "{firsts:?}");
    assert_eq!((firsts[1], firsts[2]), (None, firsts[0]));
}
