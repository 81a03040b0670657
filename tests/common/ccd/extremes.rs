//! The families of [`Family::EXTREME`]: sizes, angles and places at which a bound that is only nearly
//! right calls free what is not.
//!
//! Half of the queries are planted: at a chosen time the centres of two interpolated spheres coincide, so
//! that the bodies meet whatever their radii, and bodies without thickness pass through each other. Most
//! others pass at a gap in units of their radii. Rounding to `f32` moves what is planted; the oracle judges
//! what is left.

use super::families::{Family, Plan};
use super::motion::{Ball, Motion, Query, Rigid};
use super::rng::Rng;
use super::shapes::Spheres;
use nalgebra::Vector3;

/// A query of one of those families, before its numbers are rounded to `f32`.
pub fn query(family: Family, counts: [usize; 2], rigid: bool, rng: &mut Rng) -> Query {
    // Points without thickness meet nothing but by chance, and segments no points.
    let counts = match (family, counts) {
        (Family::Wire, [1, 1] | [1, 2] | [2, 1]) => [2, 2],
        _ => counts,
    };
    if family == Family::Bullet {
        return bullet(counts, rigid, rng);
    }
    let mut normal = None;
    let bodies = match family {
        Family::NearParallel => {
            let (bodies, across) = near_parallel(counts, rng);
            normal = Some(across);
            bodies
        }
        Family::Coaxial => coaxial(counts, rng),
        Family::Long => long(counts, rng),
        Family::Needle => counts.map(|count| needle(count, rng)),
        Family::Wire => counts.map(|count| cloud(count, 0.0, rng)),
        _ => counts.map(|count| {
            let radius = rng.log_range(1.0e-2, 0.3);
            cloud(count, radius, rng)
        }),
    };
    let radii = bodies.iter().flatten().map(|(_, radius)| *radius);
    let thickness = radii.fold(0.0, f64::max);
    let size = bodies.iter().flatten().map(|(center, _)| center.norm());
    let size = size.fold(0.0, f64::max);
    let mut plan = Plan::new(family, counts, rng);
    plan.bodies = bodies;
    plan.reach = 4.0 * size;
    plan.crossing = rng.chance(0.4);
    plan.gap = rng.range(-0.3, 1.0) * rng.log_range(1.0e-3, 1.0) * (thickness + 1.0e-3 * size);
    plan.rate = rng.chance(0.7).then_some(0.0);
    plan.angle = [0.0, rng.log_range(1.0e-3, 1.0)][rng.below(2)];
    plan.together = family == Family::NearParallel;
    // Face to face.
    plan.heading = normal.filter(|_| rng.chance(0.8));
    if family == Family::Coaxial {
        plan.heading = Some(axis(&plan.bodies));
        plan.travel *= rng.sign();
        plan.angle = 0.0;
        plan.crossing = true;
    }
    let mut query = plan.draw(rigid, rng);
    plan.place(&mut query, rng);
    if let (Family::Coaxial, Some(axis)) = (family, plan.heading)
        && rng.chance(0.6)
    {
        let beside = axis.cross(&rng.direction()).normalize();
        query.shift(0, beside * (2.0 * thickness * rng.range(0.7, 1.5)));
    }
    if family == Family::FarOrigin {
        far_off(&mut query, rng);
    }
    query
}

/// Centres in the unit ball, of one radius.
fn cloud(count: usize, radius: f64, rng: &mut Rng) -> Spheres {
    (0..count).map(|_| (rng.in_ball(), radius)).collect()
}

/// Rods, or slabs, whose axes are at a small angle; one may be much the longer. And the direction across
/// both axes.
fn near_parallel(counts: [usize; 2], rng: &mut Rng) -> ([Spheres; 2], Vector3<f64>) {
    let along = rng.direction();
    let across = along.cross(&rng.direction()).normalize();
    let angle = rng.log_range(1.0e-9, 1.0e-2);
    let radius = [0.0, rng.log_range(1.0e-6, 1.0e-2)][rng.below(2)];
    let slope = rng.chance(0.3);
    let bodies = [0.0, angle].map(|angle| {
        let count = counts[usize::from(angle > 0.0)];
        let direction = along + across * angle;
        let length = rng.log_range(1.0, 10.0);
        let beside = rng.in_ball();
        (0..count)
            .map(|k| {
                let side = if k == 2 { beside } else { Vector3::zeros() };
                let place = direction * (length * [-0.5, 0.5, 0.1][k]) + side;
                let share = if slope { rng.range(0.0, 2.0) } else { 1.0 };
                // One sphere alone needs thickness to be met.
                let least = if counts.contains(&1) { 1.0e-3 } else { 0.0 };
                (place, (radius * share).max(least))
            })
            .collect()
    });
    (bodies, along.cross(&across))
}

/// Centres on a line: rods and slivers whose radii are as small as a millionth of their length.
fn needle(count: usize, rng: &mut Rng) -> Spheres {
    let axis = rng.direction();
    let length = rng.log_range(1.0, 100.0);
    let radius = length * rng.log_range(1.0e-6, 1.0e-2);
    let bend = [0.0, radius, 1.0e-3 * length][rng.below(3)];
    (0..count)
        .map(|_| {
            let center = axis * (length * rng.range(-0.5, 0.5)) + rng.in_ball() * bend;
            (center, radius * rng.range(0.5, 1.5))
        })
        .collect()
}

/// All centres on one line through the origin.
fn coaxial(counts: [usize; 2], rng: &mut Rng) -> [Spheres; 2] {
    let axis = rng.direction();
    let equal = rng.chance(0.5);
    counts.map(|count| {
        let radius = rng.log_range(1.0e-3, 0.3);
        (0..count)
            .map(|_| {
                let share = if equal { 1.0 } else { rng.range(0.2, 2.0) };
                (axis * rng.range(-1.0, 1.0), radius * share)
            })
            .collect()
    })
}

/// The line of coaxial bodies.
fn axis(bodies: &[Spheres; 2]) -> Vector3<f64> {
    let centers = bodies.iter().flatten().map(|(center, _)| *center);
    let longest = centers.max_by(|a, b| a.norm().total_cmp(&b.norm()));
    longest.unwrap_or_else(Vector3::x).normalize()
}

/// A large body, thin or without thickness, and one of ordinary size.
fn long(counts: [usize; 2], rng: &mut Rng) -> [Spheres; 2] {
    let large = rng.below(2);
    let extent = rng.log_range(10.0, 1000.0);
    [0, 1].map(|k| {
        if k != large {
            return cloud(counts[k], rng.log_range(1.0e-3, 0.3), rng);
        }
        let radius = [0.0, rng.log_range(1.0e-3, 0.3)][rng.below(2)];
        let narrow = rng.log_range(1.0e-3, 1.0);
        let mut spheres = cloud(counts[k], radius, rng);
        for (k, (center, _)) in spheres.iter_mut().enumerate() {
            *center *= extent * if k == 2 { narrow } else { 1.0 };
        }
        spheres
    })
}

/// Moves a query far from the world's origin, and, in rigid motion, its spheres and centres of mass far from
/// those of their bodies.
fn far_off(query: &mut Query, rng: &mut Rng) {
    if rng.chance(0.5) {
        let offset = rng.direction() * rng.log_range(10.0, 1.0e4);
        query.shift(0, offset);
        query.shift(1, offset);
    }
    let Motion::Rigid(motions, _) = &mut query.motion else {
        return;
    };
    for (motion, balls) in motions.iter_mut().zip(&mut query.balls) {
        // To where an `f32` has room for it exactly: the body's own place must not change.
        let far = rng.direction() * rng.log_range(10.0, 1.0e4);
        let placed = motion.place(&Vector3::zeros(), 0.0);
        for ball in balls.iter_mut() {
            ball.center += far;
        }
        motion.local_center += far;
        let moved = motion.place(&far, 0.0);
        motion.translation += placed - moved;
    }
}

/// A small body that crosses a long way, exactly through a point close to the other one's: positions and
/// displacements that `f32` has as they are, so that it hits as planted.
fn bullet(counts: [usize; 2], rigid: bool, rng: &mut Rng) -> Query {
    let radius = rng.log_range(1.0e-6, 1.0e-2);
    let way = (rng.direction() * rng.log_range(1.0, 1.0e4)).map(|x| f64::from(x as f32));
    let beside = way.cross(&rng.direction()).normalize() * radius * rng.range(0.0, 4.0);
    let turn = rng.direction() * [0.0, rng.log_range(1.0e-3, 0.5)][rng.below(2)];
    let shift = rng.direction() * radius;
    let bodies = counts.map(|count| {
        let radius = radius * rng.range(0.5, 1.5);
        cloud(count, radius, rng)
            .into_iter()
            .map(|(center, r)| (center * radius, r))
            .collect::<Spheres>()
    });
    let flying = rng.below(2);
    let balls = [0, 1].map(|k| {
        let place = |(center, radius): &(Vector3<f64>, f64)| {
            let (center, displacement) = match (rigid, k == flying) {
                (true, _) => (*center, Vector3::zeros()),
                (false, true) => (*center + way, -way * 2.0),
                (false, false) => (*center + beside, Vector3::zeros()),
            };
            Ball {
                center,
                radius: *radius,
                displacement,
            }
        };
        bodies[k].iter().map(place).collect()
    });
    let motion = |k: usize| Rigid {
        translation: if k == flying { way } else { beside },
        rotation: [0.0, 0.0, 0.0, 1.0],
        local_center: shift * 0.5,
        linvel: if k == flying { -way * 2.0 } else { way * 0.0 },
        angvel: turn,
    };
    let motion = match rigid {
        true => Motion::Rigid(Box::new([motion(0), motion(1)]), 1.0),
        false => Motion::Straight,
    };
    Query { balls, motion }
}
