//! [`MedialDispatcher`]: the entry through which parry and rapier ask this crate about medial meshes. What it does not
//! answer falls through to parry's default dispatcher, which treats a medial mesh as a compound of convex parts.

use super::narrow_phase_plan::{PlanExchange, Sweeps};
use crate::batch::{PairJob, PairResult};
use crate::math::tolerance::FEW_OPERATIONS;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::SpherePair;
use crate::parry::contacts::deep_contact;
use crate::parry::queries::cast::Cast;
use crate::parry::queries::distance;
use crate::parry::queries::initial_contacts::AtStart;
use parry3d::query::details::ShapeCastOptions;
use parry3d::query::{
    ClosestPoints, Contact, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit, ShapeDistance,
    ShapeIntersection, Unsupported,
};
use parry3d::shape::Shape;
use std::sync::Arc;

/// A query dispatcher of parry that answers all queries between two medial meshes, and between one and any of
/// parry's own shapes: distance, intersection, closest points, contact, and both kinds of shape casts. Contact
/// manifolds with parry's shapes are the exception: it computes only those with flat faces, and has parry compute the
/// others, at a scale at which parry's tolerances are small.
///
/// [`MedialPipeline::attach`](crate::MedialPipeline::attach) sets it in a world. To use it with parry alone, chain
/// it before parry's default dispatcher:
///
/// ```
/// use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
/// use rapier3d_medial::{MedialDispatcher, MedialMesh, math::{Pose, Vector}};
///
/// let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
/// let (ring, ball) = (MedialMesh::torus(1.0, 0.2, 32)?, MedialMesh::ball(0.1)?);
/// // The ball is in the middle of the ring's hole.
/// let distance = dispatcher.distance(&Pose::from_translation(Vector::ZERO), &ring, &ball);
/// assert!(distance.is_ok_and(|d| (d.distance - 0.7).abs() < 0.01));
/// # Ok::<(), rapier3d_medial::MeshError>(())
/// ```
#[derive(Clone, Default)]
pub struct MedialDispatcher {
    pub(super) exchange: Arc<PlanExchange>,
}

impl MedialDispatcher {
    /// A dispatcher that goes by the plan that a pipeline leaves there.
    pub(crate) fn new(exchange: Arc<PlanExchange>) -> Self {
        Self { exchange }
    }

    fn cast(
        &self,
        motions: [&NonlinearRigidMotion; 2],
        shapes: [&dyn Shape; 2],
        times: [Real; 2],
        target_distance: Real,
        at_start: AtStart,
        stop_approach: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let flipped = medial(shapes[0]).is_none();
        let [first, second] = if flipped { [1, 0] } else { [0, 1] };
        let mesh = medial(shapes[first]).ok_or(Unsupported)?;
        let pos12 = motions[0].start.inv_mul(&motions[1].start);
        if self.exchange.are_contacts_off(shapes[0], shapes[1], &pos12) {
            return Ok(None);
        }
        let cast = Cast {
            motion1: motions[first],
            mesh,
            motion2: motions[second],
            other: shapes[second],
            times,
            target_distance,
            at_start,
            stop_approach,
        };
        let (hit, counts) = cast.run().map_err(|_| Unsupported)?;
        self.exchange.note(|tally| {
            tally.counts.casts += 1;
            tally.counts.work += counts;
        });
        Ok(hit.map(|h| if flipped { h.swapped() } else { h }))
    }

    fn nearest(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_distance: Real,
    ) -> Result<Option<SpherePair>, Unsupported> {
        let (found, counts) = match (medial(g1), medial(g2)) {
            (Some(mesh), _) => distance::nearest(mesh, g2, pos12, max_distance),
            (None, Some(mesh)) => distance::nearest(mesh, g1, &pos12.inverse(), max_distance)
                .map(|(pair, counts)| (pair.map(|p| flipped(p, pos12)), counts)),
            (None, None) => return Err(Unsupported),
        }
        .map_err(|_| Unsupported)?;
        self.exchange.note(|tally| tally.counts.work += counts);
        Ok(found)
    }

    /// The deepest contact: of the batch where both are medial.
    pub(super) fn deepest(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<SpherePair>, Unsupported> {
        let (Some(mesh1), Some(mesh2)) = (medial(g1), medial(g2)) else {
            return self.nearest(pos12, g1, g2, prediction);
        };
        let deepest = |found: &PairResult| {
            let near = found.contacts.iter().filter(|c| c.distance <= prediction);
            near.min_by(|a, b| a.distance.total_cmp(&b.distance))
                .copied()
        };
        let job = PairJob::of([mesh1, mesh2], pos12, prediction);
        Ok(self.exchange.contacts(job, deepest))
    }
}

/// Time by which two shapes in straight motion have met, if they do: an endless cast ends there.
fn passed_by(pos12: &Pose, velocity: Vector, g1: &dyn Shape, g2: &dyn Shape, target: Real) -> Real {
    let reach = |g: &dyn Shape| {
        let aabb = g.compute_local_aabb();
        aabb.mins.abs().max(aabb.maxs.abs()).length()
    };
    let apart = pos12.translation.length() + target.max(0.0);
    // A half-space has no end: what counts is how fast its plane is approached.
    let plane1 = g1.as_halfspace().map(|h| -velocity.dot(h.normal));
    let plane2 = || {
        let plane = g2.as_halfspace()?;
        Some(velocity.dot(pos12.rotation * plane.normal))
    };
    let (speed, size) = match (plane1, plane1.or_else(plane2)) {
        (Some(approach), _) => (approach, reach(g2)),
        (None, Some(approach)) => (approach, reach(g1)),
        (None, None) => (velocity.length(), reach(g1) + reach(g2)),
    };
    if speed <= 0.0 {
        return 0.0;
    }
    // Rounding must not end the cast before the last contact.
    let passed = (apart + size) / speed * (1.0 + FEW_OPERATIONS);
    passed.min(Real::MAX)
}

/// The pair of the swapped query, whose first body is our second.
fn flipped(pair: SpherePair, pos12: &Pose) -> SpherePair {
    let [p, q] = pair.primitives;
    let [a, b] = pair.points;
    SpherePair {
        primitives: [q, p],
        normal: pos12.rotation * -pair.normal,
        points: [b, a],
        ..pair
    }
}

/// The medial mesh that a shape is, if it is one.
pub(super) fn medial(shape: &dyn Shape) -> Option<&MedialMesh> {
    shape.as_shape::<MedialMesh>()
}

impl QueryDispatcher for MedialDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        self.exchange.note(|tally| tally.counts.intersections += 1);
        let nearest = self.nearest(pos12, g1, g2, 0.0)?;
        Ok(match nearest {
            Some(c) => {
                ShapeIntersection::new(true).with_subshapes(c.primitives[0], c.primitives[1])
            }
            None => ShapeIntersection::new(false),
        })
    }

    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        // None where poses are not finite or overflow: parry's own answer to these may panic.
        let Some(nearest) = self.nearest(pos12, g1, g2, Real::MAX)? else {
            return Ok(ShapeDistance {
                distance: Real::MAX,
                subshape1: 0,
                subshape2: 0,
            });
        };
        Ok(ShapeDistance {
            distance: nearest.distance.max(0.0),
            subshape1: nearest.primitives[0],
            subshape2: nearest.primitives[1],
        })
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        let nearest = self.nearest(pos12, g1, g2, prediction)?;
        let deepest = |nearest: SpherePair| match (medial(g1), medial(g2)) {
            (Some(mesh), _) => deep_contact::shortest_way_out(mesh, g2, pos12, nearest),
            (None, Some(mesh)) => {
                let pos21 = pos12.inverse();
                let nearest = flipped(nearest, &pos21);
                flipped(
                    deep_contact::shortest_way_out(mesh, g1, &pos21, nearest),
                    pos12,
                )
            }
            (None, None) => nearest,
        };
        Ok(nearest.map(deepest).map(|c| Contact {
            point1: c.points[0],
            point2: c.points[1],
            normal1: c.normal,
            normal2: pos12.rotation.inverse() * -c.normal,
            dist: c.distance,
            subshape1: c.primitives[0],
            subshape2: c.primitives[1],
        }))
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        Ok(match self.nearest(pos12, g1, g2, max_dist)? {
            None => ClosestPoints::Disjoint,
            Some(c) if c.distance <= 0.0 => ClosestPoints::Intersecting,
            Some(c) => ClosestPoints::WithinMargin(c.points[0], c.points[1]),
        })
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        if medial(g1).is_none() && medial(g2).is_none() {
            return Err(Unsupported);
        }
        let end = options.max_time_of_impact.min(passed_by(
            pos12,
            local_vel12,
            g1,
            g2,
            options.target_distance,
        ));
        let motion1 = NonlinearRigidMotion::identity();
        let motion2 = NonlinearRigidMotion {
            linvel: local_vel12,
            ..NonlinearRigidMotion::constant_position(*pos12)
        };
        self.cast(
            [&motion1, &motion2],
            [g1, g2],
            [0.0, end],
            options.target_distance,
            AtStart::of(options.stop_at_penetration),
            true,
        )
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        // Within its step rapier asks so of solid pairs; of what only tells of events it wants the first contact.
        let sweeps = match stop_at_penetration {
            true => Sweeps::AsCasts,
            false => self.exchange.plan().sweeps,
        };
        let at_start = match sweeps {
            Sweeps::FindNothing if medial(g1).or(medial(g2)).is_some() => return Ok(None),
            Sweeps::PassOverlaps => AtStart::Pass,
            _ => AtStart::of(stop_at_penetration),
        };
        self.cast(
            [motion1, motion2],
            [g1, g2],
            [start_time, end_time],
            0.0,
            at_start,
            false,
        )
    }
}
