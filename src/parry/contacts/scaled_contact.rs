//! parry's contacts of two convex shapes (its GJK and EPA algorithms) for bodies of any size. Their tolerances are
//! lengths of 1e-6, and squares of areas: triangles with edges of 3 cm are taken for lines, so that bodies of
//! centimetres get contacts that are aslant or too deep, and those of millimetres none. So parry is asked about the
//! smaller body with a size between 1 and 2.

use crate::math::{Pose, Real, Vector};
use parry3d::bounding_volume::Aabb;
use parry3d::query::details::{
    NormalConstraints, contact_manifold_pfm_pfm, contact_support_map_support_map,
};
use parry3d::query::{Contact, ContactManifold};
use parry3d::shape::{PolygonalFeature, PolygonalFeatureMap, SupportMap};

/// How much larger than 1 the other body may get, as a power of 2: beyond it single precision is coarser than parry's
/// tolerances, and the smaller body is asked about smaller.
const MAX_SIZE: Real = 1024.0;

/// A support map times a factor, a power of 2.
struct Scaled<'a, T: ?Sized> {
    map: &'a T,
    factor: Real,
}

impl<T: SupportMap + ?Sized> SupportMap for Scaled<'_, T> {
    fn local_support_point(&self, direction: Vector) -> Vector {
        self.map.local_support_point(direction) * self.factor
    }

    fn local_support_point_toward(&self, direction: Vector) -> Vector {
        self.map.local_support_point_toward(direction) * self.factor
    }
}

impl<T: PolygonalFeatureMap + ?Sized> PolygonalFeatureMap for Scaled<'_, T> {
    fn local_support_feature(&self, dir: Vector, out: &mut PolygonalFeature) {
        self.map.local_support_feature(dir, out);
        out.vertices = out.vertices.map(|v| v * self.factor);
    }

    fn local_support_feature_toward(&self, dir: Vector, hint: Vector, out: &mut PolygonalFeature) {
        let hint = hint * (1.0 / self.factor);
        self.map.local_support_feature_toward(dir, hint, out);
        out.vertices = out.vertices.map(|v| v * self.factor);
    }

    fn is_convex_polyhedron(&self) -> bool {
        self.map.is_convex_polyhedron()
    }
}

/// The contact of two support maps that are at most `prediction` (a length) apart; the second is at `pos12` in the
/// frame of the first. `bounds` are boxes around them with what they are to be grown by, each in its own frame.
pub fn contact(
    pos12: &Pose,
    [a, b]: [&dyn SupportMap; 2],
    bounds: [&Aabb; 2],
    prediction: Real,
) -> Option<Contact> {
    let unit = unit(bounds, pos12);
    let factor = 1.0 / unit;
    let [a, b] = [a, b].map(|map| Scaled { map, factor });
    let pose = scaled(pos12, factor);
    let found = contact_support_map_support_map(&pose, &a, &b, prediction * factor)?;
    Some(Contact {
        point1: found.point1 * unit,
        point2: found.point2 * unit,
        dist: found.dist * unit,
        ..found
    })
}

/// The manifold of two convex shapes, each its polygonal feature map and the radius it is grown by, within `bounds`;
/// `pos12` is the pose of the second in the frame of the first.
pub fn write_manifold<M: Default, C: Default + Copy>(
    pos12: &Pose,
    [(a, border1), (b, border2)]: [(&dyn PolygonalFeatureMap, Real); 2],
    bounds: [&Aabb; 2],
    [of_a, of_b]: [Option<&dyn NormalConstraints>; 2],
    prediction: Real,
    manifold: &mut ContactManifold<M, C>,
) {
    let unit = unit(bounds, pos12);
    let factor = 1.0 / unit;
    let [a, b] = [a, b].map(|map| Scaled { map, factor });
    let (pose, prediction) = (scaled(pos12, factor), prediction * factor);
    let [border1, border2] = [border1, border2].map(|border| border * factor);
    scale_points(manifold, factor);
    contact_manifold_pfm_pfm(
        &pose, &a, border1, of_a, &b, border2, of_b, prediction, manifold,
    );
    scale_points(manifold, unit);
}

/// A pose in a frame whose lengths are `factor` times as large.
fn scaled(pose: &Pose, factor: Real) -> Pose {
    Pose::from_parts(pose.translation * factor, pose.rotation)
}

/// Multiplies the lengths of a manifold's points.
fn scale_points<M, C>(manifold: &mut ContactManifold<M, C>, factor: Real) {
    for point in &mut manifold.points {
        point.local_p1 *= factor;
        point.local_p2 *= factor;
        point.dist *= factor;
    }
}

/// The length that becomes 1, a power of 2: that of the smaller body, unless coordinates would be larger than
/// [`MAX_SIZE`].
fn unit(bounds: [&Aabb; 2], pos12: &Pose) -> Real {
    let sizes = bounds.map(|b| b.extents().max_element());
    let coordinates = bounds.map(|b| b.mins.abs().max(b.maxs.abs()).max_element());
    let largest = coordinates[0].max(coordinates[1]);
    let largest = largest.max(pos12.translation.abs().max_element());
    power_of_2(sizes[0].min(sizes[1]).max(largest / MAX_SIZE))
}

/// The power of 2 at or below a size, 1 where it has none. Lengths that are divided by it lose no digit.
fn power_of_2(size: Real) -> Real {
    const EXPONENT: u32 = 0x7f80_0000;
    if size.is_normal() && size > 0.0 {
        Real::from_bits(size.to_bits() & EXPONENT)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smaller_body_is_as_large_as_1_and_none_as_large_as_can_be() {
        let bounds = |half: Real| Aabb::from_half_extents(Vector::ZERO, Vector::splat(half));
        let of = |a: Real, b: Real, x: Real| {
            unit([&bounds(a), &bounds(b)], &Pose::translation(x, 0.0, 0.0))
        };
        assert_eq!(of(0.01, 3.0, 0.0), 0.015625);
        assert_eq!(of(3.0, 0.01, 0.0), 0.015625);
        // A body of a kilometre, or a kilometre away, is 1,024 units large.
        assert_eq!(of(1.0e-3, 1000.0, 0.0), 0.5);
        assert_eq!(of(1.0e-3, 1.0e-3, 1000.0), 0.5);
        assert_eq!(of(0.0, 0.0, 0.0), 1.0);
        assert_eq!(of(Real::NAN, Real::INFINITY, 0.0), 1.0);
    }
}
