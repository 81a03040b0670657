//! Which pairs bounce within a step ([`Effects::restitution`](crate::Effects::restitution)), and what of a pair touches at
//! its start, so that rapier's solver has it.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::distance::{is_within, nearest};
use crate::rapier::effects::Effect;
use crate::rapier::impacts::impulse::Material;
use crate::rapier::impacts::toi_query::{CcdPolicy, Hit, Work, reach};
use crate::rapier::view::step_view::StepView;
use parry3d::shape::Shape;

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

    /// Whether the pair touches at the start of the step, so that the solver has it.
    pub fn touches(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> bool {
        let (mesh, other, pos12, reach) = self.at_start(view, pair);
        let found = mesh.and_then(|mesh| is_within(mesh, other, &pos12, reach).ok());
        found.is_some_and(|(within, counts)| {
            work.counts += counts;
            within
        })
    }

    /// How fast a pair that touches at the start of the step approaches at its nearest points, a length per second;
    /// `None` if it does not touch.
    pub fn approach(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> Option<Real> {
        let (mesh, other, pos12, reach) = self.at_start(view, pair);
        let (found, counts) = nearest(mesh?, other, &pos12, reach).ok()?;
        work.counts += counts;
        let contact = found?;
        let flipped = view.parts[pair[0]].medial().is_none();
        let [k, l] = if flipped { [pair[1], pair[0]] } else { pair };
        let motion = view.motion(k, 0.0);
        let point = motion.start * contact.points[0];
        let normal = motion.start.rotation * contact.normal;
        let velocity = |k: usize| {
            let m = view.motion(k, 0.0);
            m.linvel + m.angvel.cross(point - m.start * m.local_center)
        };
        Some((velocity(k) - velocity(l)).dot(normal))
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
        let reach = reach(view, pair, gap);
        match shape1.as_shape::<MedialMesh>() {
            Some(mesh) => (Some(mesh), shape2, start1.inv_mul(&start2), reach),
            None => (shape2.as_shape(), shape1, start2.inv_mul(&start1), reach),
        }
    }
}
