//! Straight casts that come down on a plane at a small angle, as a character's do: where they hit, against the plane in
//! `f64`.

use crate::rng::Rng;
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher, ShapeCastOptions};
use rapier3d::parry::shape::{Cuboid, Shape};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::{MedialDispatcher, MedialMesh};

/// Half extents of the ground, whose upper face is the plane y = 0.
const GROUND: Vector = Vector::new(5.0, 0.5, 5.0);

/// What the gap at a hit may be off the target distance, a length: what rounding makes of coordinates up to 3 m.
const OFF: f64 = 4.0e-6;

/// Symptom: hits at less than 30 degrees were 0.1 mm nearer than the target distance. Cause: what may only slide along
/// is searched again that much nearer, and the hit was told there. Symptom: what began less than .1 mm farther off than
/// the target distance was hit at time 0, so that characters stood still on flat ground. Cause: that was the tolerance.
#[test]
fn shallow_casts_hit_at_their_target_distance() {
    let half = Vector::new(0.3, 0.2, 0.25);
    let block = MedialMesh::cuboid(half).expect("a box");
    let medial_ground = MedialMesh::cuboid(GROUND).expect("a ground");
    let grounds: [&dyn Shape; 2] = [&Cuboid::new(GROUND), &medial_ground];
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mut rng = Rng::new(5);
    let mut random = |low: f64, high: f64| rng.range(low, high) as Real;
    let (mut hits, mut worst) = (0, [0.0_f64; 2]);
    for k in 0..3000 {
        let turn = Vector::Y * random(-3.0, 3.0);
        let target_distance = [0.0, 0.01, 0.1][(random(0.0, 3.0) as usize).min(2)];
        let farther = if k % 2 == 0 {
            random(1.0e-3, 0.02)
        } else {
            random(1.0e-5, 1.0e-4)
        };
        let gap = target_distance + farther;
        let at = Vector::new(random(-2.0, 0.0), half.y + gap, random(-1.0, 1.0));
        let pose = Pose::new(at, turn);
        let angle = random(0.02, 0.7);
        let way = Vector::new(angle.cos(), -angle.sin(), 0.0);
        let options = ShapeCastOptions {
            max_time_of_impact: 2.0,
            target_distance,
            stop_at_penetration: false,
            compute_impact_geometry_on_penetration: true,
        };
        let ground_at = Pose::from_translation(Vector::NEG_Y * GROUND.y);
        for ground in grounds {
            let pos12 = pose.inverse() * ground_at;
            let velocity = pose.rotation.inverse() * -way;
            let found = dispatcher
                .cast_shapes(&pos12, velocity, &block, ground, options)
                .expect("supported");
            let reaches = f64::from(gap - target_distance) < 2.0 * f64::from(angle.sin());
            let Some(hit) = found else {
                assert!(
                    !reaches,
                    "missed at {angle} from {gap} to {target_distance}"
                );
                continue;
            };
            hits += 1;
            let left = f64::from(gap) - f64::from(hit.time_of_impact) * f64::from(angle).sin();
            let off = left - f64::from(target_distance);
            worst = [worst[0].min(off), worst[1].max(off)];
        }
    }
    println!("{hits} hits, off by {worst:?}");
    assert!(hits > 3000, "{hits}");
    assert!(worst[0] > -OFF && worst[1] < OFF, "off by {worst:?}");
}

/// Half sides of the rectangle in the middle of a plate, and the radius of its rim (m).
const PLATE: [f64; 3] = [0.4, 0.3, 0.05];

/// Distance of the rectangles of two plates in one plane that do not overlap: of the second at a place, turned by an
/// angle.
fn between_rectangles(place: [f64; 2], angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let from_middle = |[x, z]: [f64; 2]| {
        let out = [x.abs() - PLATE[0], z.abs() - PLATE[1]].map(|d| d.max(0.0));
        out[0].hypot(out[1])
    };
    let distances = corners.map(|[i, k]| {
        let [x, z] = [i * PLATE[0], k * PLATE[1]];
        // A turn about y takes x to -z.
        let of_second = [place[0] + cos * x + sin * z, place[1] - sin * x + cos * z];
        let [x, z] = [x - place[0], z - place[1]];
        let of_first = [cos * x - sin * z, sin * x + cos * z];
        from_middle(of_second).min(from_middle(of_first))
    });
    distances.into_iter().fold(f64::MAX, f64::min)
}

/// Plates that overlap by their rims and lie in one plane: no direction across their faces or edges says how deep they
/// are in each other. Symptom: some that come apart were told to hit later. The distance of convex bodies on straight
/// paths is a convex function of time, so what grows at the start never shrinks.
#[test]
fn plates_in_one_plane_that_come_apart_do_not_hit() {
    let [x, z, radius] = PLATE.map(|length| length as Real);
    let plate = MedialMesh::round_plate(x, z, radius).expect("a plate");
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mut rng = Rng::new(7);
    let mut cast = 0;
    for _ in 0..20_000 {
        let mut random = |low: f64, high: f64| rng.range(low, high);
        let place = [random(-1.0, 1.0), random(-1.0, 1.0)];
        let (turn, angle) = (random(-3.1, 3.1), random(-3.1, 3.1));
        let way = [angle.cos(), angle.sin()];
        let gap = between_rectangles(place, turn);
        // Nearer than this to each other they overlap, however they are turned.
        let is_near = place[0].hypot(place[1]) < 2.0 * PLATE[1];
        let later = between_rectangles([0, 1].map(|k| place[k] + 1.0e-3 * way[k]), turn);
        if is_near || !(0.01..2.0 * PLATE[2]).contains(&gap) || later < gap + 1.0e-4 {
            continue;
        }
        cast += 1;
        let [at, velocity] = [place, way].map(|[x, z]| Vector::new(x as Real, 0.0, z as Real));
        let options = ShapeCastOptions {
            max_time_of_impact: 2.0,
            target_distance: 0.0,
            stop_at_penetration: false,
            compute_impact_geometry_on_penetration: true,
        };
        let pose = Pose::new(at, Vector::Y * turn as Real);
        let hit = dispatcher
            .cast_shapes(&pose, velocity, &plate, &plate, options)
            .expect("supported");
        assert!(
            hit.is_none(),
            "at {place:?}, turned by {turn}, along {way:?}: {hit:?}"
        );
    }
    println!("{cast} casts");
    assert!(cast > 500, "{cast}");
}
