//! The planes that each ball of a medial mesh should go on touching, as quadrics.
//!
//! Source: Li et al., "Q-MAT" (2015), §4; boundary planes as Garland and Heckbert, "Surface
//! simplification using quadric error metrics" (1997), §6.

use crate::error::BuildError;
use crate::meshing::axis::tangent::TangentPlane;
use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::quadric::{Quadric, cone_normals, slab_normals};
use crate::meshing::simplify::complex::Complex;
use crate::meshing::watch::Watch;

/// Cosine of the angle between two faces at an edge below which one lies on the other.
const FOLDED: f64 = 0.99;

/// Weight of the planes that hold the boundary of a solid's medial mesh in place.
pub const BOUNDARY_WEIGHT_SOLID: f64 = 0.1;
/// Weight of the planes that hold the boundary of a thin sheet in place, which is the boundary of the surface itself.
pub const BOUNDARY_WEIGHT_SHEET: f64 = 1.0;

/// Radius (longest side 1) below which both balls of an edge, if no crease's, make it a sheet's.
const SHEET_RADIUS: f64 = 1.5e-3;

/// Weight of the plane across the wedge or tip of a crease, at a ball of radius 0: it holds the ball against
/// sinking into matter along the bisector. With 4 a plate's rim is off by .02, with 16 by .0003.
const TIP_WEIGHT: f64 = 16.0;

/// Stability ratio ρ = max(0, d − |r1 − r2|)/d: 0 where one ball contains the other.
pub fn stability(a: &Ball, b: &Ball) -> f64 {
    let d = (b.center - a.center).length();
    if d > 0.0 {
        ((d - (b.radius - a.radius).abs()) / d).max(0.0)
    } else {
        0.0
    }
}

/// Planes that each ball should go on touching: those of its slabs, and where the medial mesh ends,
/// planes that hold its boundary.
pub fn quadrics(
    complex: &Complex,
    boundary_weight: f64,
    watch: &mut Watch,
) -> Result<Vec<Quadric>, BuildError> {
    let balls = &complex.balls;
    let mut quadrics = vec![Quadric::default(); balls.len()];
    for face in complex.faces() {
        let corners = face.map(|v| balls[v as usize]);
        for n in slab_normals(corners).into_iter().flatten() {
            for (&v, ball) in face.iter().zip(&corners) {
                quadrics[v as usize].add_plane(n, ball, 1.0);
            }
        }
    }
    for a in 0..balls.len() as u32 {
        if a % 512 == 0 {
            watch.at(0.0)?;
        }
        for &b in complex.neighbors(a).iter().filter(|&&b| b > a) {
            add_end(complex, [a, b], boundary_weight, &mut quadrics);
        }
    }
    Ok(quadrics)
}

/// Adds the planes that hold the boundary of the medial mesh in place, at an edge of one face or none.
fn add_end(complex: &Complex, [a, b]: [u32; 2], weight: f64, quadrics: &mut [Quadric]) {
    let balls = &complex.balls;
    let is_thin = |v: u32| (1e-9..SHEET_RADIUS).contains(&balls[v as usize].radius);
    let weight = match is_thin(a) && is_thin(b) {
        true => BOUNDARY_WEIGHT_SHEET,
        false => weight,
    };
    let mut opposite = complex.opposite(a, b);
    match (opposite.next(), opposite.next()) {
        (None, _) => add_dangling(complex, [a, b], weight, quadrics),
        (Some(c), None) => add_boundary(balls, [a, b, c], weight, quadrics),
        // The two sides of something flat meet at its outline. Slabs of a solid's medial
        // mesh fold by chance only.
        (Some(c), Some(d)) if weight >= BOUNDARY_WEIGHT_SHEET && folds(balls, [a, b], [c, d]) => {
            add_boundary(balls, [a, b, c], weight, quadrics);
        }
        _ => {}
    }
}

/// Whether the faces `abc` and `abd` lie on each other, within a few degrees.
fn folds(balls: &[Ball], ab: [u32; 2], cd: [u32; 2]) -> bool {
    let at = |v: u32| balls[v as usize].center;
    let [a, b] = ab.map(at);
    let along = direction(b - a);
    let inward = |v: u32| {
        let from_a = at(v) - a;
        direction(from_a - along * from_a.dot(along))
    };
    inward(cd[0]).dot(inward(cd[1])) > FOLDED
}

/// Boundary edge `ab` of the face `abc`: a plane across the face, facing away from `c`.
fn add_boundary(balls: &[Ball], abc: [u32; 3], weight: f64, quadrics: &mut [Quadric]) {
    let [a, b, c] = abc.map(|v| balls[v as usize]);
    let along = direction(b.center - a.center);
    let from_c = a.center - c.center;
    let outward = direction(from_c - along * from_c.dot(along));
    if outward.length_sq() > 0.0 {
        let weight = weight * stability(&a, &b).powi(2);
        quadrics[abc[0] as usize].add_plane(outward, &a, weight);
        quadrics[abc[1] as usize].add_plane(outward, &b, weight);
    }
}

/// Edge `ab` without a face: four planes of its cone, and one across the axis at an end that is
/// joined to nothing else.
fn add_dangling(complex: &Complex, ab: [u32; 2], weight: f64, quadrics: &mut [Quadric]) {
    let [a, b] = ab.map(|v| complex.balls[v as usize]);
    let Some(normals) = cone_normals(&a, &b) else {
        return;
    };
    for n in normals {
        quadrics[ab[0] as usize].add_plane(n, &a, 1.0);
        quadrics[ab[1] as usize].add_plane(n, &b, 1.0);
    }
    let axis: Point = direction(b.center - a.center);
    let weight = weight * stability(&a, &b).powi(2);
    for (v, ball, outward) in [(ab[0], a, -axis), (ab[1], b, axis)] {
        if complex.neighbors(v).len() == 1 {
            quadrics[v as usize].add_plane(outward, &ball, weight);
        }
    }
}

/// The quadrics of balls whose planes are known, and of where their medial mesh ends within the solid;
/// `flat` says that all faces are.
pub fn creased_quadrics(
    complex: &Complex,
    planes: &[Vec<TangentPlane>],
    flat: bool,
    watch: &mut Watch,
) -> Result<Vec<Quadric>, BuildError> {
    let balls = &complex.balls;
    let mut quadrics = vec![Quadric::default(); balls.len()];
    for ((quadric, planes), ball) in quadrics.iter_mut().zip(planes).zip(balls) {
        for plane in planes {
            quadric.add_plane(plane.normal, ball, 1.0);
        }
        if ball.radius == 0.0 {
            let sum = planes.iter().fold(Point::zero(), |sum, p| sum + p.normal);
            quadric.add_plane(direction(sum), ball, TIP_WEIGHT);
        }
    }
    // Sheets of flat faces end on creases or at other sheets: any other end was not resolved.
    let ends = if flat { 0 } else { balls.len() as u32 };
    for a in 0..ends {
        if a % 512 == 0 {
            watch.at(0.0)?;
        }
        let inner = |v: u32| balls[v as usize].radius > 0.0;
        for &b in complex
            .neighbors(a)
            .iter()
            .filter(|&&b| b > a && inner(a) && inner(b))
        {
            add_end(complex, [a, b], BOUNDARY_WEIGHT_SOLID, &mut quadrics);
        }
    }
    Ok(quadrics)
}
