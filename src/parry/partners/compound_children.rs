//! The children of a compound that matter in a region of space, by the compound's hierarchy of boxes: a query of a
//! level of thousands of tiles looks at the few around the body.

use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Real, Vector};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::partitioning::BvhNode;
use parry3d::query::PointQuery;
use parry3d::shape::Compound;

/// Box around what is below a node of a compound's hierarchy, loosened by what parry's rounding of boxes and poses may
/// take off. A child whose corners are far from its own origin, and moved back by its pose, may be off by more.
fn holding(node: &BvhNode) -> Aabb {
    let aabb = node.aabb();
    let size = aabb.mins.abs().max(aabb.maxs.abs()).max_element();
    aabb.loosened(REAL_ROUNDING * size)
}

/// Children whose boxes `region` (in the compound's frame) meets, in ascending order. A region that is not a number
/// meets all.
pub fn children_in(compound: &Compound, region: &Aabb) -> Vec<u32> {
    let meets = |node: &BvhNode| {
        let held = holding(node);
        let apart = held.mins.cmpgt(region.maxs) | region.mins.cmpgt(held.maxs);
        !apart.any()
    };
    let mut children: Vec<u32> = compound.bvh().leaves(meets).collect();
    children.sort_unstable();
    children
}

/// The least of a length (not negative) over all children, at most `Real::MAX`. That of a child must be no less than
/// the distance of `point` to it, divided by `slack`.
pub fn least_over_children(
    compound: &Compound,
    point: Vector,
    slack: Real,
    length: impl Fn(u32) -> Real,
) -> Real {
    let rounding = REAL_ROUNDING * point.abs().max_element();
    let at_least = |node: &BvhNode, _| {
        let distance = holding(node).distance_to_local_point(point, true);
        // Children below a box of NaN are looked at.
        (distance / slack - rounding).max(0.0)
    };
    let least = compound
        .bvh()
        .find_best(Real::MAX, at_least, |child, _| Some(length(child)));
    least.map_or(Real::MAX, |(_, length)| length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::medial::MedialSphere;
    use crate::parry::partners::inside::{holds_point, min_translation, most_distance};
    use crate::parry::partners::shape_faces::for_each_flat_face;
    use parry3d::shape::SharedShape;
    use std::cell::Cell;

    /// Numbers in [-1, 1), the same in every run.
    fn numbers() -> impl FnMut() -> Real {
        let mut state = 1u32;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as Real / (1 << 23) as Real - 1.0
        }
    }

    /// A vector of such numbers.
    fn vector(number: &mut impl FnMut() -> Real) -> Vector {
        Vector::new(number(), number(), number())
    }

    /// Solids of every kind that a compound may have, here and there in a block 8 m wide.
    fn heap(count: usize, number: &mut impl FnMut() -> Real) -> Compound {
        let solids = (0..count).map(|i| {
            let half = (vector(number) + 1.1) * 0.4;
            let at = vector(number) * 4.0;
            let (x, y) = (half.x, half.y);
            let solid = match i % 7 {
                0 => SharedShape::cuboid(x, y, half.z),
                1 => SharedShape::round_cuboid(x, y, half.z, 0.2),
                2 => SharedShape::ball(x),
                3 => SharedShape::capsule_y(y, x),
                4 => SharedShape::cylinder(y, x),
                5 => SharedShape::cone(y, x),
                _ => {
                    let corners: Vec<Vector> = (0..9).map(|_| vector(number)).collect();
                    SharedShape::convex_hull(&corners).unwrap_or_else(|| SharedShape::ball(y))
                }
            };
            (Pose::new(at, vector(number) * 3.0), solid)
        });
        Compound::new(solids.collect())
    }

    /// 40 by 40 copies of a shape, a metre apart, in a plane.
    fn tiles(tile: &SharedShape) -> Compound {
        let at = |k: usize| Vector::new((k % 40) as Real, 0.0, (k / 40) as Real);
        let tiles = (0..1600).map(|k| (Pose::from_translation(at(k)), tile.clone()));
        Compound::new(tiles.collect())
    }

    /// A box of a tenth of a tile's width in the middle of one.
    fn on_a_tile() -> Aabb {
        Aabb::from_half_extents(Vector::new(17.0, 0.5, 23.0), Vector::splat(0.05))
    }

    /// Symptom: a ball over 6,400 tiles took 9 ms a step, over 100 tiles 0.1 ms. Cause: each query walked all children.
    #[test]
    fn of_many_tiles_only_those_near_a_body_are_looked_at() {
        let region = on_a_tile();
        let ground = tiles(&SharedShape::cuboid(0.5, 0.5, 0.5));
        let mut faces = 0;
        for_each_flat_face(&ground, &Pose::IDENTITY, &region, &mut |_| faces += 1);
        assert_eq!(faces, 6);

        let looked_at = Cell::new(0);
        let length = |child: u32| {
            looked_at.set(looked_at.get() + 1);
            let (pose, s) = &ground.shapes()[child as usize];
            most_distance(s.as_ref(), pose.inverse_transform_point(region.center()))
        };
        least_over_children(&ground, region.center(), 1.0, length);
        assert!((1..=9).contains(&looked_at.get()), "{looked_at:?}");
    }

    /// Oracle: every child by itself.
    #[test]
    fn points_have_the_same_answers_as_by_a_walk_over_all_children() {
        let mut number = numbers();
        let (mut held, mut ways) = (0, 0);
        for _ in 0..20 {
            let heap = heap(140, &mut number);
            for _ in 0..50 {
                let spheres: Vec<MedialSphere> = (0..3)
                    .map(|_| MedialSphere::new(vector(&mut number) * 4.0, 0.1))
                    .collect();
                let point = spheres[0].center;
                let children = || heap.shapes().iter().map(|(pose, s)| (pose, s.as_ref()));
                let local = |pose: &Pose| pose.inverse_transform_point(point);

                let holds = children().any(|(pose, s)| holds_point(s, local(pose)));
                assert_eq!(holds_point(&heap, point), holds);
                held += usize::from(holds);

                let distances = children().map(|(pose, s)| most_distance(s, local(pose)));
                let least = distances.fold(Real::MAX, Real::min);
                assert_eq!(most_distance(&heap, point).to_bits(), least.to_bits());

                let way = children().filter_map(|(pose, s)| {
                    let placed = |b: &MedialSphere| {
                        MedialSphere::new(pose.inverse_transform_point(b.center), b.radius)
                    };
                    let placed: Vec<MedialSphere> = spheres.iter().map(placed).collect();
                    min_translation(s, &placed).map(|way| way.depth)
                });
                let way = way.max_by(Real::total_cmp);
                assert_eq!(min_translation(&heap, &spheres).map(|w| w.depth), way);
                ways += usize::from(way.is_some());
            }
        }
        assert!((50..900).contains(&held), "{held} points are held");
        assert!((100..900).contains(&ways), "{ways} have a way out");
    }

    /// Oracle: the boxes of all children, one by one.
    #[test]
    fn a_region_has_the_children_whose_boxes_it_meets_in_their_order() {
        let mut number = numbers();
        let mut met = 0;
        for count in [1, 2, 70, 700] {
            let heap = heap(count, &mut number);
            for _ in 0..50 {
                let half = (vector(&mut number) + 1.0) * 0.5;
                let region = Aabb::from_half_extents(vector(&mut number) * 5.0, half);
                let boxes = heap.aabbs().iter().zip(0..);
                let all: Vec<u32> = boxes
                    .filter_map(|(aabb, child)| aabb.intersects(&region).then_some(child))
                    .collect();
                assert_eq!(children_in(&heap, &region), all);
                met += all.len();
            }
        }
        assert!(met > 400, "{met} children are met");
        let nowhere = Aabb::new(Vector::NAN, Vector::NAN);
        assert_eq!(children_in(&heap(70, &mut number), &nowhere).len(), 70);
    }
}
