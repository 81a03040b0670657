//! Targets of numbers: meshes made from any, and queries about them.

use super::mutate::{AWKWARD, Rng};
use parry3d::query::{
    DefaultQueryDispatcher, NonlinearRigidMotion, PointQuery, QueryDispatcher, Ray, RayCast,
    ShapeCastOptions,
};
use parry3d::shape::{Shape, SharedShape};
use rapier3d_medial::elementary::{self, InitialContact, MovingSphere, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::parry::MedialDispatcher;
use rapier3d_medial::{MedialMesh, MedialSphere, pair};

fn vector(rng: &mut Rng) -> Vector {
    Vector::new(rng.number(), rng.number(), rng.number())
}

/// A mesh, if these numbers make one; what it says of itself is then finite.
pub fn mesh(rng: &mut Rng) -> Option<MedialMesh> {
    // Half of the meshes have no awkward number, or few would be left to ask.
    let plain = rng.below(2) == 0;
    let number = |rng: &mut Rng| if plain { rng.unit() } else { rng.number() };
    let count = 1 + rng.below(8);
    let mut spheres: Vec<_> = (0..count)
        .map(|_| {
            let c = Vector::new(number(rng), number(rng), number(rng));
            let r = 0.3 * number(rng);
            MedialSphere::new(c, if plain { r.abs() } else { r })
        })
        .collect();
    if rng.below(8) == 0 {
        spheres.push(spheres[0]);
    }
    // Seldom one that is not there.
    let most = spheres.len() + usize::from(rng.below(8) == 0);
    let index = |rng: &mut Rng| rng.below(most) as u32;
    let edges = (0..rng.below(6)).map(|_| [index(rng), index(rng)]);
    let edges: Vec<_> = edges.collect();
    let faces = (0..rng.below(4)).map(|_| [index(rng), index(rng), index(rng)]);
    let faces: Vec<_> = faces.collect();
    let mesh = MedialMesh::new(spheres, edges, faces).ok()?;
    let aabb = mesh.aabb();
    assert!(aabb.mins.is_finite() && aabb.maxs.is_finite(), "{mesh:?}");
    assert!(mesh.thickness() >= 0.0 && !mesh.volume().is_nan());
    let mass = mesh.mass_properties(1.0);
    assert!(mass.local_com.is_finite() && mass.inv_mass.is_finite());
    Some(mesh)
}

/// What is wrong with a mesh is told; what is right has a size.
pub fn new(rng: &mut Rng) {
    mesh(rng);
}

/// A motion over a second: any number of turns.
fn motion(rng: &mut Rng) -> NonlinearRigidMotion {
    let fast = *rng.pick(&[1.0, 1.0, 1.0, 40.0, 1.0e4]);
    let turn = vector(rng) * fast;
    let center = vector(rng);
    let start = Pose::new(vector(rng), vector(rng));
    NonlinearRigidMotion::new(start, center, vector(rng) * 3.0, turn)
}

fn options(rng: &mut Rng) -> ToiOptions {
    ToiOptions {
        tolerance: rng.number().abs() * 0.01,
        time_tolerance: rng.number().abs() * 0.01,
        target_distance: rng.number() * 0.1,
        initial_contact: match rng.below(4) {
            0 => InitialContact::Deepen {
                by: rng.number().abs() * 0.1,
            },
            _ => InitialContact::Stop,
        },
        ..ToiOptions::default()
    }
}

fn check(toi: &elementary::Toi) {
    assert!(
        toi.lower >= 0.0 && toi.lower <= toi.upper && toi.upper <= 1.0,
        "{toi:?}"
    );
    assert!(toi.status != ToiStatus::Separated || toi.lower == 1.0);
}

/// Single primitives, straight and turning.
pub fn elementary(rng: &mut Rng) {
    let mut moving = || -> Vec<MovingSphere> {
        let sphere = |rng: &mut Rng| MovingSphere {
            center: vector(rng),
            radius: rng.number().abs(),
            displacement: vector(rng),
        };
        (0..1 + rng.below(3)).map(|_| sphere(rng)).collect()
    };
    let (a, b) = (moving(), moving());
    let options = options(rng);
    check(&elementary::first_contact(&a, &b, &options));
    elementary::alternating(&a, &b, &options);
    let still = |all: &[MovingSphere]| -> Vec<_> {
        all.iter()
            .map(|s| MedialSphere::new(s.center, s.radius))
            .collect()
    };
    let (m, n) = (motion(rng), motion(rng));
    let seconds = rng.number();
    let (a, b) = (still(&a), still(&b));
    check(&elementary::first_contact_rigid(
        &a, &m, &b, &n, seconds, &options,
    ));
    let exact = elementary::f64::ToiOptions::default();
    let toi = elementary::f64::first_contact_rigid(&a, &m, &b, &n, seconds.into(), &exact);
    assert!(toi.lower >= 0.0 && toi.lower <= toi.upper, "{toi:?}");
}

/// Two meshes.
pub fn pairs(rng: &mut Rng) {
    if let (Some(a), Some(b)) = (mesh(rng), mesh(rng)) {
        let (m, n) = (motion(rng), motion(rng));
        let (seconds, options) = (rng.number(), options(rng));
        check(&pair::first_contact(&a, &m, &b, &n, seconds, &options));
        let pose = m.start.inv_mul(&n.start);
        pair::nearest_spheres(&a, &b, &pose, rng.number());
    }
}

fn others(rng: &mut Rng) -> SharedShape {
    // Lengths whose squares underflow trip a debug assertion of parry's segments and capsules.
    let length = |x: Real| if x * x == 0.0 { 0.0 } else { x.abs() };
    let [x, y, z] = [0; 3].map(|_| length(rng.number()));
    match rng.below(9) {
        0 => SharedShape::ball(x),
        1 => SharedShape::cuboid(x, y, z),
        2 => SharedShape::capsule_y(x, y),
        3 => SharedShape::cylinder(x, y),
        4 => SharedShape::cone(x, y),
        // A border that is no number trips an assertion of parry's box of it.
        5 => SharedShape::round_cone(x, y, if z.is_nan() { 0.0 } else { z }),
        6 => SharedShape::halfspace(Vector::Y),
        7 => {
            let (vertices, indices) = parry3d::shape::Ball::new(0.4).to_trimesh(5, 5);
            SharedShape::trimesh(vertices, indices).expect("a surface")
        }
        _ => {
            let along = vector(rng).map(length);
            SharedShape::segment(Vector::ZERO, along)
        }
    }
}

/// A mesh with rapier's shapes: every query.
pub fn shapes(rng: &mut Rng) {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let Some(a) = mesh(rng) else { return };
    let other = others(rng);
    let (m, n) = (motion(rng), motion(rng));
    let (seconds, distance) = (rng.number(), rng.number());
    let cast = ShapeCastOptions {
        max_time_of_impact: seconds.abs(),
        target_distance: distance,
        stop_at_penetration: rng.below(2) == 0,
        compute_impact_geometry_on_penetration: true,
    };
    let pos12 = m.start.inv_mul(&n.start);
    let other = &*other;
    let _ = dispatcher.distance(&pos12, &a, other);
    let _ = dispatcher.intersection_test(&pos12, &a, other);
    let _ = dispatcher.closest_points(&pos12, &a, other, distance.abs());
    let _ = dispatcher.contact(&pos12, &a, other, distance.abs());
    let _ = dispatcher.cast_shapes(&pos12, n.linvel, &a, other, cast);
    let stop = cast.stop_at_penetration;
    let hit = dispatcher.cast_shapes_nonlinear(&m, &a, &n, other, 0.0, seconds.abs(), stop);
    if let Ok(Some(hit)) = hit {
        assert!(hit.time_of_impact >= 0.0, "{hit:?}");
    }
    rays(rng, &a);
}

fn rays(rng: &mut Rng, mesh: &MedialMesh) {
    let ray = Ray::new(vector(rng), vector(rng));
    let most = if rng.below(4) == 0 {
        *rng.pick(&AWKWARD)
    } else {
        Real::MAX
    };
    let solid = rng.below(2) == 0;
    if let Some(hit) = mesh.cast_local_ray_and_get_normal(&ray, most, solid) {
        assert!(hit.time_of_impact >= 0.0, "{hit:?}");
    }
    let point = vector(rng);
    mesh.project_local_point(point, solid);
    mesh.feature_normal_at_point(0, parry3d::shape::FeatureId::Face(0), point);
}
