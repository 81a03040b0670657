//! Casts and distances of loose spheres against boxes of any size, plain, rounded or of triangles, near their
//! edges and corners and far from the world's origin: of a wide face only what can be reached is looked at. The
//! distance of a point to a box is a closed form, so that the oracle marches in `f64`, and no step of it is
//! longer than what is left of that distance.

use crate::rng::Rng;
use crate::rotating::{rotation, vector};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use parry3d::math::{Pose, Real, Rotation, Vector};
use parry3d::query::details::ShapeCastOptions;
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher};
use parry3d::shape::{Cuboid, SharedShape};
use rapier3d_medial::parry::MedialDispatcher;
use rapier3d_medial::parry::queries::cast::Cast;
use rapier3d_medial::parry::queries::initial_contacts::AtStart;
use rapier3d_medial::{MedialMesh, MedialSphere, ToiOptions, ToiStatus};

const CASES: usize = 12_000;

/// Shortest step of the oracle's march: meanwhile nothing moves by more than 2e-5 m, and what is overlooked is
/// less deep than that.
const SHORTEST: f64 = 2.0e-6;

/// What rounding of a relative pose to `f32` takes from a distance, in units of the largest coordinate: some
/// ulps.
const ROUNDING: f64 = 1.0e-6;

/// How much deeper than the target a cast may let bodies get, a length: its times are rounded down.
const LATE: f64 = 1.0e-9;

/// What rounding takes from a time, a fraction of the cast.
const TIME: f64 = 2.0e-7;

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x.into(), v.y.into(), v.z.into())
}

/// A motion in double precision.
struct Path {
    center: Vector3<f64>,
    local_center: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    linvel: Vector3<f64>,
    angvel: Vector3<f64>,
}

impl Path {
    fn new(motion: &NonlinearRigidMotion) -> Self {
        let q = motion.start.rotation;
        let [x, y, z, w] = [q.x, q.y, q.z, q.w].map(f64::from);
        let rotation = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
        let local_center = wide(motion.local_center);
        Self {
            center: wide(motion.start.translation) + rotation * local_center,
            local_center,
            rotation,
            linvel: wide(motion.linvel),
            angvel: wide(motion.angvel),
        }
    }

    fn at(&self, t: f64) -> nalgebra::Isometry3<f64> {
        let rotation = UnitQuaternion::from_scaled_axis(self.angvel * t) * self.rotation;
        let origin = self.center + self.linvel * t - rotation * self.local_center;
        nalgebra::Isometry3::from_parts(Translation3::from(origin), rotation)
    }
}

/// Some spheres, and a box of half extents `half`, rounded by `border`.
struct Case {
    spheres: Vec<MedialSphere>,
    half: Vector3<f64>,
    border: f64,
    paths: [Path; 2],
}

impl Case {
    fn distance(&self, t: f64) -> f64 {
        let [body, other] = self.paths.each_ref().map(|path| path.at(t));
        let seen = other.inv_mul(&body);
        let of = |s: &MedialSphere| {
            let p = (seen * Point3::from(wide(s.center))).coords;
            let out = (p.abs() - self.half).map(|x| x.max(0.0));
            out.norm() - self.border - f64::from(s.radius)
        };
        self.spheres.iter().map(of).fold(f64::MAX, f64::min)
    }

    /// Bound on the speed of any point of a sphere, seen from the box.
    fn speed(&self) -> f64 {
        let [body, other] = &self.paths;
        let arm = |s: &MedialSphere| (wide(s.center) - body.local_center).norm();
        let own = self.spheres.iter().map(arm).fold(0.0, f64::max);
        let slide = body.linvel.norm() + other.linvel.norm();
        let apart = (body.center - other.center).norm() + slide + own;
        slide + body.angvel.norm() * own + other.angvel.norm() * apart
    }

    /// The least distance until `end`, or less than `target` where it falls below that; and when that is.
    fn least(&self, target: f64, end: f64) -> (f64, f64) {
        let (mut t, mut least) = (0.0, f64::MAX);
        let speed = self.speed();
        loop {
            let distance = self.distance(t);
            least = least.min(distance);
            if least < target || t >= end {
                return (least, t);
            }
            t = (t + ((distance - target) / speed).max(SHORTEST)).min(end);
        }
    }
}

/// A point of a box's surface, more often than not near an edge or a corner.
fn on_surface(rng: &mut Rng, half: Vector3<f64>) -> Vector3<f64> {
    let axis = rng.below(3);
    let mut point = half.map(|h| match rng.below(3) {
        0 => h * rng.sign(),
        1 => (h - rng.range(0.0, 0.4)) * rng.sign(),
        _ => h * rng.range(-1.0, 1.0),
    });
    point[axis] = half[axis] * rng.sign();
    point
}

#[test]
fn of_a_wide_face_what_is_near_is_hit() {
    let dispatcher = MedialDispatcher::default();
    let mut rng = Rng::new(71);
    let [mut hits, mut free, mut cases] = [0; 3];
    while cases < CASES {
        let half = Vector3::from_fn(|_, _| rng.log_range(0.05, 60.0) as Real);
        let border = if rng.chance(0.5) {
            0.0
        } else {
            rng.log_range(0.01, 0.3) as Real
        };
        let sphere = |rng: &mut Rng| {
            let radius = rng.log_range(0.02, 0.3) as Real;
            MedialSphere::new(vector(rng.in_ball() * 0.4), radius)
        };
        // One sphere that does not turn reaches as far as is looked, and no further.
        let alone = rng.chance(0.3);
        let count = if alone { 1 } else { 1 + rng.below(3) };
        let spheres: Vec<_> = (0..count).map(|_| sphere(&mut rng)).collect();
        // Where single precision resolves as little as 2 mm.
        let place = rng
            .chance(0.5)
            .then(|| rng.direction() * rng.log_range(1.0e3, 2.0e4));
        let place = vector(place.unwrap_or_default());
        let moves = if alone || rng.chance(0.5) { 0.0 } else { 1.0 };
        let motion2 = NonlinearRigidMotion {
            start: Pose::from_parts(place + vector(rng.in_ball() * 5.0), rotation(&mut rng)),
            local_center: vector(rng.in_ball() * 0.3),
            linvel: vector(rng.in_ball() * moves),
            angvel: vector(rng.in_ball() * 0.05 * moves),
        };
        let aimed = motion2.start * vector(on_surface(&mut rng, half.map(f64::from)));
        let from = aimed + vector(rng.direction() * rng.range(0.5, 2.0));
        let to = aimed + vector(rng.in_ball() * 0.6);
        let motion1 = NonlinearRigidMotion {
            start: Pose::from_parts(from, rotation(&mut rng)),
            local_center: vector(rng.in_ball() * 0.3),
            linvel: (to - from) * rng.range(0.5, 2.0) as Real,
            angvel: vector(rng.in_ball() * if alone { 0.0 } else { 3.0 }),
        };
        let case = Case {
            spheres: spheres.clone(),
            half: half.map(f64::from),
            border: border.into(),
            paths: [&motion1, &motion2].map(Path::new),
        };
        let at_start = case.distance(0.0);
        if at_start < 0.05 {
            continue;
        }
        cases += 1;
        let mesh = MedialMesh::new(spheres, vec![], vec![]).expect("loose spheres");
        let cuboid = if border > 0.0 {
            SharedShape::round_cuboid(half.x, half.y, half.z, border)
        } else if rng.chance(0.5) {
            SharedShape::cuboid(half.x, half.y, half.z)
        } else {
            let (corners, triangles) = Cuboid::new(vector(half.map(f64::from))).to_trimesh();
            SharedShape::trimesh(corners, triangles).expect("a closed surface")
        };
        let rounding = ROUNDING * f64::from(half.max() + 8.0);
        let pos12 = motion1.start.inv_mul(&motion2.start);
        let distance = dispatcher.distance(&pos12, &mesh, &*cuboid);
        let distance = f64::from(distance.expect("supported").distance);
        assert!(
            (distance - at_start).abs() < rounding,
            "{distance} {at_start}"
        );

        let target = if rng.chance(0.5) { 0.0 } else { 0.03 };
        // Some just touch.
        let (_, met) = case.least(target - rng.log_range(3.0e-5, 3.0e-3), 1.0);
        let seconds = if rng.chance(0.5) { met as Real } else { 1.0 };
        let cast = Cast {
            motion1: &motion1,
            mesh: &mesh,
            motion2: &motion2,
            other: &*cuboid,
            times: [0.0, seconds],
            target_distance: target as Real,
            at_start: AtStart::Stop,
            stop_approach: true,
        };
        let options = ToiOptions {
            target_distance: target as Real,
            ..ToiOptions::default()
        };
        let toi = cast.toi(&options, None).expect("a built-in shape").toi;
        let share = match toi.status {
            ToiStatus::Separated => 1.0,
            _ => f64::from(toi.lower),
        };
        let end = share * f64::from(seconds);
        let (least, _) = case.least(target - LATE, end);
        let said = || format!("{toi:?}, least {least}, target {target}, {half:?}, {border}");
        assert!(least >= target - LATE, "late or missed: {}", said());
        if toi.status == ToiStatus::Separated {
            free += 1;
        } else {
            hits += 1;
            let there = case.distance(end) - target;
            let tolerance = f64::from(toi.tolerance) + TIME * case.speed();
            assert!(there <= tolerance, "early by {there}: {}", said());
        }
    }
    println!("{hits} hits, {free} free");
    assert!(hits > CASES / 4 && free > CASES / 4, "{hits} {free}");
}

/// A child of a compound whose own origin is far from where it is touched: rounding of its pose takes none of
/// its faces away.
#[test]
fn a_face_far_from_its_own_origin_is_there() {
    let dispatcher = MedialDispatcher::default();
    let ball = MedialMesh::ball(0.1).expect("a ball");
    let mut rng = Rng::new(72);
    for size in [1.0, 30.0, 300.0, 3_000.0] {
        let corners = Cuboid::new(Vector::splat(size)).to_trimesh().0;
        let children = [
            SharedShape::cuboid(size, size, size),
            SharedShape::convex_hull(&corners).expect("a hull"),
        ];
        for (child, _) in children.iter().flat_map(|c| (0..400).map(move |k| (c, k))) {
            let turn = Rotation::from_scaled_axis(Vector::Y * rng.range(-3.0, 3.0) as Real);
            let down = Pose::from_parts(Vector::NEG_Y * size, turn);
            let compound = SharedShape::compound(vec![(down, child.clone())]);
            let gap = rng.log_range(1.0e-5, 0.1) as Real;
            let place = vector(rng.in_ball() * 0.2);
            let at = Pose::from_translation(Vector::new(place.x, 0.1 + gap, place.z));
            let distance = dispatcher.distance(&at.inverse(), &ball, &*compound);
            let distance = distance.expect("supported").distance;
            let rounding = 4.0 * Real::EPSILON * size + 1.0e-6;
            assert!(
                (distance - gap).abs() < rounding,
                "{size}: {distance} {gap}"
            );
            let falls = NonlinearRigidMotion {
                linvel: Vector::NEG_Y,
                ..NonlinearRigidMotion::constant_position(at)
            };
            let cast = Cast {
                motion1: &falls,
                mesh: &ball,
                motion2: &NonlinearRigidMotion::identity(),
                other: &*compound,
                times: [0.0, 1.0],
                target_distance: 0.0,
                at_start: AtStart::Stop,
                stop_approach: true,
            };
            let toi = cast
                .toi(&ToiOptions::default(), None)
                .expect("built in")
                .toi;
            let late = toi.lower - gap - rounding;
            assert!(
                toi.status != ToiStatus::Separated && late <= 0.0,
                "{size}: {toi:?} {gap}"
            );
        }
    }
}

/// A card that comes down flat on a ring, a link or a frame is told to touch it where both are, not in the hole
/// between.
#[test]
fn witnesses_of_flat_contacts_are_on_both_bodies() {
    let mut rng = Rng::new(73);
    let dispatcher = MedialDispatcher::default();
    let card = MedialMesh::cuboid(Vector::new(0.5, 0.01, 0.4)).expect("a card");
    let bodies = [
        MedialMesh::torus(0.5, 0.1, 24).expect("a ring"),
        MedialMesh::rectangle_frame(0.5, 0.3, 0.08).expect("a link"),
        MedialMesh::box_frame(Vector::new(0.4, 0.3, 0.4), 0.06).expect("a frame"),
    ];
    let off = |mesh: &MedialMesh, p: Vector| {
        let distances = mesh.primitives().map(|q| q.signed_distance(p).distance);
        distances.fold(Real::MAX, Real::min).abs()
    };
    let mut hits = 0;
    for case in 0..600 {
        let body = &bodies[case % 3];
        let mut part = || rng.range(-1.0, 1.0) as Real;
        let turn = Rotation::from_rotation_y(3.0 * part());
        let at = Vector::new(0.4 * part(), 1.0, 0.4 * part());
        let pose = Pose::from_parts(at, turn);
        let velocity = Vector::new(0.2 * part(), -1.0, 0.2 * part());
        let options = ShapeCastOptions::with_max_time_of_impact(3.0);
        let hit = dispatcher
            .cast_shapes(&pose, velocity, body, &card, options)
            .expect("swept");
        let Some(hit) = hit else { continue };
        let off = [off(body, hit.witness1), off(&card, hit.witness2)];
        assert!(
            off[0] < 1.0e-4 && off[1] < 1.0e-4,
            "{case}: {off:?}, {hit:?}"
        );
        hits += 1;
    }
    assert!(hits > 500, "{hits}");
}
