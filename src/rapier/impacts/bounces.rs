//! Which pairs bounce within a step ([`Effects::restitution`](crate::Effects::restitution), whose inequality is in
//! `docs/effects.md`), and what of a pair touches at its start, so that rapier's solver has it.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::distance::{is_within, nearest};
use crate::rapier::effects::Effect;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::impulse::Material;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::view::motion::Kind;
use crate::rapier::view::step_view::StepView;
use parry3d::shape::Shape;

/// Turn in a step, in radians, from which a body that a joint holds may swing. Motors turn wheels by less, and its square
/// over 6 is 0.04 of the way.
const SWINGS: Real = 0.5;

/// By how much of its thickness the arc of a body's contact point ends short of its tangent before the body swings.
const SHORT: Real = 0.5;

impl CcdPolicy<'_> {
    /// Speed of approach, in units of length per second, up to which a pair does not bounce: twice what forces add in a
    /// step, so that what rests stays at rest.
    pub fn least_bounce(&self, view: &StepView, pair: [usize; 2]) -> Real {
        2.0 * view.most_pull(pair) + self.tuning.least_bounce * self.unit
    }

    /// Share of the step for which forces still act on what meets at `time`, a time in seconds. rapier moves bodies in
    /// each sub-step by the velocity at its end, which is that of its middle, so velocities are half a sub-step behind.
    fn share_after(&self, time: Real) -> Real {
        1.0 - time / self.dt - 0.5 / self.substeps as Real
    }

    /// Whether the pair has restitution, and may meet so fast in this step that it bounces.
    pub fn may_bounce(&self, view: &StepView, pair: [usize; 2]) -> bool {
        let effects = self.effects_of(view, pair);
        let is_wanted = match effects.restitution {
            Effect::On => true,
            Effect::Off => false,
            Effect::Auto => !view.may_be_pressed(pair),
        };
        is_wanted
            && effects.stop != Effect::On
            && view.restitution(pair) > 0.0
            && view.travel(pair, self.dt) > self.least_bounce(view, pair) * self.dt
    }

    /// The approach, a length per second, from which the impulse of a hit is to be computed, and the material, without
    /// restitution where the pair does not bounce. A bounce is from the velocity that the bodies have where they meet;
    /// forces add the rest of theirs after it.
    pub fn bounce(
        &self,
        view: &StepView,
        pair: [usize; 2],
        hit: &Hit,
        approach: Vector,
        material: Material,
    ) -> (Vector, Material) {
        let at_contact = approach - view.relative_pull(pair) * self.share_after(hit.time);
        if material.restitution > 0.0 && -at_contact.dot(hit.normal) > self.least_bounce(view, pair)
        {
            return (at_contact, material);
        }
        let restitution = 0.0;
        (
            approach,
            Material {
                restitution,
                ..material
            },
        )
    }

    /// Whether the pair touches at the start of the step, so that the solver has it. What is pressed together and rolls or
    /// rocks leaves its contact by about what the pull moves it in a step, and touches all the same while it approaches no
    /// faster than the pull explains: left to impacts at single points a ring would whirl on for ever.
    pub fn touches(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> bool {
        let (mesh, other, pos12, reach) = self.at_start(view, pair);
        let mut within = |reach| {
            let found = mesh.and_then(|mesh| is_within(mesh, other, &pos12, reach).ok());
            found.is_some_and(|(within, counts)| {
                work.counts += counts;
                within
            })
        };
        let pulled = self.reach(view, pair, view.most_pull(pair) * self.dt);
        if pulled <= reach {
            return within(reach);
        }
        // Most pairs are farther apart, and looked at once.
        within(pulled)
            && (within(reach) || {
                let speeds = self.speeds_along_normal(view, pair, pulled, work);
                speeds.is_some_and(|[v1, v2]| v1 - v2 <= self.least_bounce(view, pair))
            })
    }

    /// How fast a pair that touches at the start of the step approaches at its nearest points, a length per second;
    /// `None` if it does not touch.
    pub fn approach(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> Option<Real> {
        let reach = self.at_start(view, pair).3;
        let [v1, v2] = self.speeds_along_normal(view, pair, reach, work)?;
        Some(v1 - v2)
    }

    /// Whether a body that a joint holds leaves the straight path of its contact point: it turns while it moves along the
    /// normal of a pair that touches at the start of the step, and the other flies free. By a way `s` along the
    /// normal and a turn `θ` about the joint, an arc ends `s θ² / 6` short of its tangent, to first order.
    pub fn swings(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> bool {
        let bodies = pair.map(|k| &view.bodies[view.parts[k].body]);
        let turns = bodies.map(|b| b.motion.angvel.length() * self.dt);
        let held = match bodies.map(|b| b.jointed) {
            [true, false] => 0,
            [false, true] => 1,
            _ => return false,
        };
        if bodies.iter().any(|b| b.kind != Kind::Free) || turns[held] <= SWINGS {
            return false;
        }
        let reach = self.at_start(view, pair).3;
        let Some(speeds) = self.speeds_along_normal(view, pair, reach, work) else {
            return false;
        };
        let way = speeds[held].abs() * self.dt;
        way * turns[held] * turns[held] / 6.0 > SHORT * view.thickness(pair)
    }

    /// Speeds of both bodies' points at the nearest points of a pair that is within `reach` (a length) at the start of the
    /// step, along its normal, a length per second; `None` if it is not.
    fn speeds_along_normal(
        &self,
        view: &StepView,
        pair: [usize; 2],
        reach: Real,
        work: &mut Work,
    ) -> Option<[Real; 2]> {
        let (mesh, other, pos12, _) = self.at_start(view, pair);
        let (found, counts) = nearest(mesh?, other, &pos12, reach).ok()?;
        work.counts += counts;
        let contact = found?;
        let flipped = view.parts[pair[0]].medial().is_none();
        let k = pair[usize::from(flipped)];
        let motion = view.motion(k, 0.0);
        let point = motion.start * contact.points[0];
        let outward = motion.start.rotation * contact.normal;
        let normal = if flipped { -outward } else { outward };
        Some(pair.map(|k| {
            let m = view.motion(k, 0.0);
            let velocity = m.linvel + m.angvel.cross(point - m.start * m.local_center);
            velocity.dot(normal)
        }))
    }

    /// The medial mesh of a pair and the other shape, which the pose at the start of the step takes to the mesh's frame,
    /// and the distance, a length, up to which they touch.
    fn at_start<'v>(
        &self,
        view: &'v StepView,
        pair: [usize; 2],
    ) -> (Option<&'v MedialMesh>, &'v dyn Shape, Pose, Real) {
        let gap = self.tuning.touching * self.gap(view.thickness(pair));
        let [start1, start2] = pair.map(|k| view.motion(k, 0.0).start);
        let [shape1, shape2] = pair.map(|k| &*view.parts[k].shape);
        let reach = self.reach(view, pair, gap);
        match shape1.as_shape::<MedialMesh>() {
            Some(mesh) => (Some(mesh), shape2, start1.inv_mul(&start2), reach),
            None => (shape2.as_shape(), shape1, start2.inv_mul(&start1), reach),
        }
    }
}
