//! How fast two colliders move against each other where they may meet: what decides whether rapier's solver gets them.
//! Parts of medial meshes are looked at one by one in [`crate::rapier::impacts::fast_parts`].

use crate::math::tolerance::FEW_OPERATIONS;
use crate::math::{Real, Vector};
use crate::rapier::view::step_view::StepView;
use parry3d::bounding_volume::{Aabb, BoundingVolume};

impl StepView {
    /// Bound on how fast the surfaces of two colliders move against each other, a length per second, in all places
    /// where they may come within `margin` from `time` to `end`; 0 if they do not.
    ///
    /// While two rigid bodies overlap, their penetration depth grows no faster than they move against each other in any
    /// point of the line between their nearest spheres, of which one lies in both bodies, so in the boxes that both
    /// sweep. The relative velocity `v1 + ω1 × (x − c1) − v2 − ω2 × (x − c2)` is affine in the place `x` and the time,
    /// as the centres `c` move straight, so it is largest in a corner of the common box, at the first or the last
    /// moment.
    pub fn meeting_speed(&self, pair: [usize; 2], [time, end]: [Real; 2], margin: Real) -> Real {
        let swept = |k: usize| {
            let aabb = self.swept_aabb(k, time, end);
            aabb.loosened(margin + self.colliders[k].skin)
        };
        let common = swept(pair[0]).intersection(&swept(pair[1]));
        let below = |common: Option<Aabb>, (k, other): (usize, usize)| {
            self.below_plane(k, common?, margin + self.colliders[other].skin)
        };
        let orders = [(pair[0], pair[1]), (pair[1], pair[0])];
        let Some(common) = orders.into_iter().fold(common, below) else {
            return 0.0;
        };
        let motions = pair.map(|k| self.motion(k, time));
        let moments = [0.0, end - time].map(|seconds| {
            motions.each_ref().map(|m| {
                let center = m.start * m.local_center + m.linvel * seconds;
                (center, m.linvel, m.angvel)
            })
        });
        let corners = common.vertices();
        let speeds = corners.iter().flat_map(|x| {
            let at = |(center, linvel, angvel): (Vector, Vector, Vector)| {
                linvel + angvel.cross(*x - center)
            };
            moments.map(|[a, b]| (at(a) - at(b)).length())
        });
        // Rounding: a few ulps.
        speeds.fold(0.0, Real::max) * (1.0 + FEW_OPERATIONS)
    }

    /// Box of the part of a box that is below a half-space's plane or within `margin` of it; all of the box if the
    /// collider is no half-space, or moves. The box of a half-space is the whole world, in which a wheel's top would
    /// count as meeting it.
    fn below_plane(&self, part: usize, aabb: Aabb, margin: Real) -> Option<Aabb> {
        let p = &self.colliders[part];
        let motion = &self.bodies[p.body].motion;
        let still = motion.linvel == Vector::ZERO && motion.angvel == Vector::ZERO;
        let Some(plane) = p.shape.as_halfspace().filter(|_| still) else {
            return Some(aabb);
        };
        let pose = self.motion(part, 0.0).start;
        let normal = pose.rotation * plane.normal;
        let size = aabb.mins.abs().max(aabb.maxs.abs()) + pose.translation.abs();
        let rounding = FEW_OPERATIONS * size.element_sum();
        let height = normal.dot(pose.translation) + margin + p.skin + rounding;
        box_below(aabb, normal, height)
    }
}

/// Box of the part of a box in which `normal · x` is no more than `height`; `None` if there is none.
fn box_below(aabb: Aabb, normal: Vector, height: Real) -> Option<Aabb> {
    let lowest = (normal * aabb.mins).min(normal * aabb.maxs);
    let (mut mins, mut maxs) = (aabb.mins, aabb.maxs);
    for axis in 0..3 {
        // The height that is left for this coordinate where the two others add least.
        let room = height - (lowest.element_sum() - lowest[axis]);
        if normal[axis] > 0.0 {
            maxs[axis] = maxs[axis].min(room / normal[axis]);
        } else if normal[axis] < 0.0 {
            mins[axis] = mins[axis].max(room / normal[axis]);
        }
    }
    mins.cmple(maxs).all().then(|| Aabb::new(mins, maxs))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_points_below_a_plane_are_in_the_box_and_it_is_no_larger_than_needed() {
        let mut state = 1u32;
        let mut unit = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as Real / 16_777_216.0 * 2.0 - 1.0
        };
        let mut vector = || Vector::new(unit(), unit(), unit());
        for _ in 0..300 {
            let (middle, half, normal) = (vector(), vector().abs(), vector().normalize());
            let aabb = Aabb::from_half_extents(middle, half);
            let height = normal.dot(middle) + 0.3 * vector().x;
            let points = (0..4000).map(|_| middle + half * vector());
            let below = points.filter(|p| normal.dot(*p) <= height);
            let cut = box_below(aabb, normal, height);
            let mut reached = [middle.map(|_| Real::MAX), middle.map(|_| Real::MIN)];
            for p in below {
                let cut = cut.expect("a point is below");
                let out = (cut.mins - p).max(p - cut.maxs).max_element();
                assert!(out < 1.0e-6, "{out} outside");
                reached = [reached[0].min(p), reached[1].max(p)];
            }
            // Where the plane cuts off more than a corner the samples reach nearly all of it.
            if let Some(cut) = cut.filter(|_| height > normal.dot(middle)) {
                let spare = (reached[0] - cut.mins).max(cut.maxs - reached[1]) / half;
                assert!(spare.max_element() < 0.5, "{spare} spare");
            }
        }
    }
}
