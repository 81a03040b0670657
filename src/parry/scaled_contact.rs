//! parry's contact of two support maps (its GJK and EPA algorithms) for bodies of any size. Their tolerances are
//! lengths, about 1e-6: bodies of centimetres get a wrong way out, those of millimetres none. So they are asked about
//! the bodies as large as 1.

use crate::math::{Pose, Real, Vector};
use parry3d::query::Contact;
use parry3d::query::details::contact_support_map_support_map;
use parry3d::shape::SupportMap;

/// A support map times a factor.
struct Scaled<'a> {
    map: &'a dyn SupportMap,
    factor: Real,
}

impl SupportMap for Scaled<'_> {
    fn local_support_point(&self, direction: Vector) -> Vector {
        self.map.local_support_point(direction) * self.factor
    }

    fn local_support_point_toward(&self, direction: Vector) -> Vector {
        self.map.local_support_point_toward(direction) * self.factor
    }
}

/// The contact of two support maps that are at most `prediction` (a length) apart; the second is at `pos12` in the
/// frame of the first.
pub fn contact(pos12: &Pose, [a, b]: [&dyn SupportMap; 2], prediction: Real) -> Option<Contact> {
    let unit = power_of_2(extent(a).min(extent(b)));
    let factor = 1.0 / unit;
    let [a, b] = [a, b].map(|map| Scaled { map, factor });
    let pose = Pose::from_parts(pos12.translation * factor, pos12.rotation);
    let found = contact_support_map_support_map(&pose, &a, &b, prediction * factor)?;
    Some(Contact {
        point1: found.point1 * unit,
        point2: found.point2 * unit,
        dist: found.dist * unit,
        ..found
    })
}

/// The largest side of the box around a support map, a length.
fn extent(map: &dyn SupportMap) -> Real {
    let side = |n: Vector| n.dot(map.local_support_point(n) - map.local_support_point(-n));
    Vector::AXES.map(side).into_iter().fold(0.0, Real::max)
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
