//! Bodies for the families of hard queries: one to three spheres each, in the body's frame.

use super::distance::PerCorner;
use super::families::Family;
use super::rng::Rng;
use nalgebra::Vector3;

/// Centres and radii.
pub type Spheres = Vec<(Vector3<f64>, f64)>;

/// Both bodies of a query.
pub fn pair(family: Family, counts: [usize; 2], rng: &mut Rng) -> [Spheres; 2] {
    match family {
        Family::Parallel => parallel(counts, rng),
        Family::NearEqual => near_equal(counts, rng),
        Family::Disparity => {
            let mut bodies = counts.map(|count| ordinary(count, rng));
            let small = rng.below(2);
            // The spheres of the small body may still be far apart.
            let spread = [1.0e-4, 1.0][rng.below(2)];
            for (center, radius) in &mut bodies[small] {
                *center *= spread;
                *radius *= 1.0e-4;
            }
            bodies
        }
        _ => counts.map(|count| match family {
            Family::Thin => thin(count, rng),
            Family::Coincident => coincident(count, rng),
            Family::Contained => contained(count, rng),
            Family::ZeroSize => zero_size(count, rng),
            Family::TwoContacts => slender(count, rng),
            _ => ordinary(count, rng),
        }),
    }
}

/// Weights of an interpolated pair of spheres, uniform enough.
pub fn weights(corners: usize, rng: &mut Rng) -> PerCorner {
    let mut weights = PerCorner::default();
    for weight in &mut weights[..corners] {
        *weight = -rng.range(1.0e-9, 1.0).ln();
    }
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

fn ordinary(count: usize, rng: &mut Rng) -> Spheres {
    (0..count)
        .map(|_| (rng.in_ball(), rng.range(0.02, 0.3)))
        .collect()
}

fn slender(count: usize, rng: &mut Rng) -> Spheres {
    (0..count)
        .map(|_| (rng.direction(), rng.range(0.005, 0.02)))
        .collect()
}

fn thin(count: usize, rng: &mut Rng) -> Spheres {
    let axis = rng.direction();
    let flat = rng.chance(0.5);
    (0..count)
        .map(|_| {
            let across = rng.in_ball() * if flat { 1.0 } else { 1.0e-4 };
            (
                axis * rng.range(-1.0, 1.0) + across,
                rng.log_range(1.0e-4, 1.0e-3),
            )
        })
        .collect()
}

fn parallel(counts: [usize; 2], rng: &mut Rng) -> [Spheres; 2] {
    let axis = rng.direction();
    let across = if rng.chance(0.5) {
        Vector3::zeros()
    } else {
        rng.in_ball()
    };
    let disturbance = [0.0, 1.0e-7, 1.0e-4][rng.below(3)];
    let equal = rng.chance(0.5);
    counts.map(|count| {
        let radius = rng.range(0.02, 0.3);
        (0..count)
            .map(|k| {
                let side = if k == 2 { across } else { Vector3::zeros() };
                let center = axis * rng.range(-1.0, 1.0) + side + rng.in_ball() * disturbance;
                (center, if equal { radius } else { rng.range(0.02, 0.3) })
            })
            .collect()
    })
}

fn coincident(count: usize, rng: &mut Rng) -> Spheres {
    let mut spheres = ordinary(count, rng);
    let first = spheres[0];
    let same_radius = rng.chance(0.5);
    let copies = 1 + rng.below(count);
    for sphere in &mut spheres[..copies] {
        sphere.0 = first.0;
        if same_radius {
            sphere.1 = first.1;
        }
    }
    spheres
}

fn contained(count: usize, rng: &mut Rng) -> Spheres {
    let mut spheres = ordinary(count, rng);
    let (center, radius) = (spheres[0].0 * 0.3, rng.range(0.5, 1.0));
    spheres[0] = (center, radius);
    for sphere in &mut spheres[1..] {
        sphere.1 *= 0.5;
        // At 1 it touches the large sphere from inside.
        let depth = [rng.range(0.0, 1.0), 1.0, 1.0 + 1.0e-6][rng.below(3)];
        sphere.0 = center + rng.direction() * (depth * (radius - sphere.1));
    }
    spheres
}

fn zero_size(count: usize, rng: &mut Rng) -> Spheres {
    let mut spheres = ordinary(count, rng);
    match rng.below(4) {
        0 => spheres.iter_mut().for_each(|sphere| sphere.1 = 0.0),
        1 => spheres[0].1 = 0.0,
        2 if count == 3 => {
            let along = rng.range(-0.5, 1.5);
            spheres[2].0 = spheres[0].0 + (spheres[1].0 - spheres[0].0) * along;
        }
        _ => {
            let center = spheres[0].0;
            spheres.iter_mut().for_each(|sphere| sphere.0 = center);
        }
    }
    spheres
}

fn near_equal(counts: [usize; 2], rng: &mut Rng) -> [Spheres; 2] {
    let model = ordinary(3, rng);
    counts.map(|count| {
        let nudge = |x: f64, rng: &mut Rng| {
            let ulps = rng.range(-3.0, 3.0).round();
            x * (1.0 + ulps * f64::from(f32::EPSILON))
        };
        model[..count]
            .iter()
            .map(|(c, r)| (c.map(|x| nudge(x, rng)), nudge(*r, rng)))
            .collect()
    })
}
