//! Decides which pairs bounce within a step ([`Effects::restitution`](crate::Effects::restitution), whose inequality is
//! in `docs/effects.md`), and which pairs touch at its start already, and are left to rapier's solver.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::queries::distance::{is_within, nearest};
use crate::rapier::effects::Effect;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::impulse::Material;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;
use parry3d::shape::Shape;

/// Turn in a step, in radians, from which a body that a joint holds may swing. Motors turn wheels by less, and its
/// square over 6 is 0.04 of the way.
const SWING_TURN: Real = 0.5;

/// Distance by which the arc of a contact point ends short of its tangent, in units of the pair's thickness, from which
/// the body counts as swinging.
const SWING_DEVIATION: Real = 0.5;

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

    /// Whether the pair touches at the start of the step, so that the solver has it. What is pressed together and rolls
    /// or rocks leaves its contact by about what the pull moves it in a step. It touches all the same while its nearest
    /// points move no faster along the normal than the pull explains, and slide by no more than its thickness in a
    /// step: left to impacts at single points a ring would whirl on for ever.
    pub fn touches(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> bool {
        let (mesh, other, pos12, _) = self.at_start(view, pair);
        let reach = self.touching_reach(view, pair);
        let pressed = self.pressed_reach(view, pair);
        let found = mesh.and_then(|mesh| is_within(mesh, other, &pos12, pressed).ok());
        let is_near = found.is_some_and(|(within, counts)| {
            work.counts += counts;
            within
        });
        if !is_near || pressed <= reach {
            return is_near;
        }
        let Some(nearest) = self.nearest_at_start(view, pair, work) else {
            return false;
        };
        let [v1, v2] = nearest.velocities;
        let along = (v1 - v2).dot(nearest.normal);
        let slide = ((v1 - v2) - nearest.normal * along).length() * self.dt;
        nearest.distance <= reach
            || along.abs() <= self.least_bounce(view, pair) && slide <= view.thickness(pair)
    }

    /// How fast a pair that touches at the start of the step approaches at its nearest points, a length per second;
    /// `None` if it does not touch.
    pub fn approach(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> Option<Real> {
        let nearest = self.nearest_at_start(view, pair, work)?;
        let [v1, v2] = nearest.velocities;
        Some((v1 - v2).dot(nearest.normal))
    }

    /// Whether a body that a joint holds leaves the straight path of its contact point: it turns while it moves along
    /// the normal of a pair that touches at the start of the step, and the other flies free. By a way `s` along the
    /// normal and a turn `θ` about the joint, an arc ends `s θ² / 6` short of its tangent, to first order.
    pub fn swings(&self, view: &StepView, pair: [usize; 2], work: &mut Work) -> bool {
        let bodies = pair.map(|k| &view.bodies[view.colliders[k].body]);
        let turns = bodies.map(|b| b.motion.angvel.length() * self.dt);
        let held = match bodies.map(|b| b.jointed) {
            [true, false] => 0,
            [false, true] => 1,
            _ => return false,
        };
        if bodies.iter().any(|b| b.mobility != Mobility::Free) || turns[held] <= SWING_TURN {
            return false;
        }
        let Some(nearest) = self.nearest_at_start(view, pair, work) else {
            return false;
        };
        let speed = nearest.velocities[held].dot(nearest.normal);
        let way = speed.abs() * self.dt;
        way * turns[held] * turns[held] / 6.0 > SWING_DEVIATION * view.thickness(pair)
    }

    /// The nearest points of a pair that touches at the start of the step or is pressed; `None` if it is farther apart.
    fn nearest_at_start(
        &self,
        view: &StepView,
        pair: [usize; 2],
        work: &mut Work,
    ) -> Option<NearestPoints> {
        let (mesh, other, pos12, flipped) = self.at_start(view, pair);
        let (found, counts) = nearest(mesh?, other, &pos12, self.pressed_reach(view, pair)).ok()?;
        work.counts += counts;
        let contact = found?;
        let motion = view.motion(pair[usize::from(flipped)], 0.0);
        let point = motion.start * contact.points[0];
        let outward = motion.start.rotation * contact.normal;
        Some(NearestPoints {
            distance: contact.distance,
            normal: if flipped { -outward } else { outward },
            velocities: pair.map(|k| {
                let m = view.motion(k, 0.0);
                m.linvel + m.angvel.cross(point - m.start * m.local_center)
            }),
        })
    }

    /// The medial mesh of a pair and the other shape, which the pose at the start of the step takes to the mesh's
    /// frame, and whether the mesh is the second.
    fn at_start<'v>(
        &self,
        view: &'v StepView,
        pair: [usize; 2],
    ) -> (Option<&'v MedialMesh>, &'v dyn Shape, Pose, bool) {
        let [start1, start2] = pair.map(|k| view.motion(k, 0.0).start);
        let [shape1, shape2] = pair.map(|k| &*view.colliders[k].shape);
        match shape1.as_shape::<MedialMesh>() {
            Some(mesh) => (Some(mesh), shape2, start1.inv_mul(&start2), false),
            None => (shape2.as_shape(), shape1, start2.inv_mul(&start1), true),
        }
    }

    /// Distance of the shapes of a pair, a length, up to which it touches.
    fn touching_reach(&self, view: &StepView, pair: [usize; 2]) -> Real {
        let gap = self.tuning.touching * self.gap(view.thickness(pair));
        self.reach(view, pair, gap)
    }

    /// The same, or what a pull moves a body away in a step, where that is more; at most what the solver looks at.
    fn pressed_reach(&self, view: &StepView, pair: [usize; 2]) -> Real {
        let pulled = (view.most_pull(pair) * self.dt).min(self.prediction);
        self.touching_reach(view, pair)
            .max(self.reach(view, pair, pulled))
    }
}

/// Nearest points of a pair.
struct NearestPoints {
    /// Distance of the shapes, a length.
    distance: Real,
    /// From the first to the second, in the world.
    normal: Vector,
    /// Velocities of both bodies at the first one's nearest point.
    velocities: [Vector; 2],
}
