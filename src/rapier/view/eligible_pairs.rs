//! Decides which pairs of colliders may meet in the step: by rapier's own rules (groups, body types, joints, filters),
//! and by the boxes that they sweep.

use crate::math::Real;
use crate::rapier::view::filter_answers::FilterAnswers;
use crate::rapier::view::motion::{Body, Mobility};
use crate::rapier::view::overlapping_boxes::overlapping_pairs;
use crate::rapier::view::step_view::StepView;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::{ImpulseJointSet, MultibodyJointSet, RigidBodySet, RigidBodyType};
use rapier3d::geometry::{ColliderSet, SolverFlags};
use rapier3d::pipeline::ActiveHooks;

/// Rules by which two colliders respond to each other (`narrow_phase/pair_update.rs` of rapier 0.36, in its order).
#[derive(Clone, Copy)]
pub struct Rules<'a> {
    /// Bodies.
    pub bodies: &'a RigidBodySet,
    /// Colliders.
    pub colliders: &'a ColliderSet,
    /// Joints, some of which turn contacts off.
    pub impulse_joints: &'a ImpulseJointSet,
    /// Multibodies, likewise.
    pub multibody_joints: &'a MultibodyJointSet,
    /// Filters of the user.
    pub filter_answers: &'a FilterAnswers<'a>,
}

impl Rules<'_> {
    /// Whether rapier would let them push each other. Pairs whose contacts the user modifies are left
    /// to rapier.
    pub fn respond(&self, view: &StepView, pair: [usize; 2]) -> bool {
        self.may_respond(view, pair) && self.filters_let(view, pair)
    }

    /// Whether they push each other if the user's filters, which are not asked, let them.
    pub fn may_respond(&self, view: &StepView, pair: [usize; 2]) -> bool {
        let [h1, h2] = pair.map(|k| view.colliders[k].handle);
        let (Some(c1), Some(c2)) = (self.colliders.get(h1), self.colliders.get(h2)) else {
            return false;
        };
        let body = |h| self.bodies.get(h).map(|b| b.body_type());
        let types = [c1, c2].map(|c| c.parent().and_then(body).unwrap_or(RigidBodyType::Fixed));
        let typed = [c1, c2]
            .iter()
            .any(|c| c.active_collision_types().test(types[0], types[1]));
        if !typed
            || !c1.collision_groups().test(c2.collision_groups())
            || !c1.solver_groups().test(c2.solver_groups())
        {
            return false;
        }
        if let (Some(b1), Some(b2)) = (c1.parent(), c2.parent()) {
            let mut joints = self.impulse_joints.joints_between(b1, b2);
            if joints.any(|(_, j)| !j.data.contacts_enabled) {
                return false;
            }
            let links = [b1, b2].map(|b| self.multibody_joints.rigid_body_link(b));
            if let [Some(l1), Some(l2)] = links
                && l1.multibody == l2.multibody
            {
                // Both are driven by their joints; nothing here could push them.
                return false;
            }
        }
        let active = c1.active_hooks() | c2.active_hooks();
        !active.contains(ActiveHooks::MODIFY_SOLVER_CONTACTS)
    }

    /// Whether a joint holds their bodies together.
    pub fn are_jointed(&self, view: &StepView, pair: [usize; 2]) -> bool {
        let [first, second] = pair.map(|k| view.bodies[view.colliders[k].body].handle);
        let (Some(first), Some(second)) = (first, second) else {
            return false;
        };
        let mut joints = self.impulse_joints.joints_between(first, second);
        joints.next().is_some()
    }

    /// Whether the user's filters, if any, let them push each other.
    fn filters_let(&self, view: &StepView, pair: [usize; 2]) -> bool {
        let handles = pair.map(|k| view.colliders[k].handle);
        let hooks = handles.map(|h| self.colliders.get(h).map(|c| c.active_hooks()));
        let mut hooks = hooks.into_iter().flatten();
        if !hooks.any(|h| h.contains(ActiveHooks::FILTER_CONTACT_PAIRS)) {
            return true;
        }
        let world = (self.bodies, self.colliders);
        let flags = self.filter_answers.of_pair(view, world, handles);
        flags.is_some_and(|f| f.contains(SolverFlags::COMPUTE_RIGID_IMPULSES))
    }
}

/// Whether an impact between two colliders is for the event loop to find: one of them medial, one of
/// them free, and one awake.
pub fn is_ccd_candidate(view: &StepView, [i, j]: [usize; 2]) -> bool {
    let (p, q) = (&view.colliders[i], &view.colliders[j]);
    let (a, b) = (&view.bodies[p.body], &view.bodies[q.body]);
    let free = |body: &Body| body.mobility == Mobility::Free;
    p.body != q.body
        && (free(a) || free(b))
        && (a.awake || b.awake)
        && (p.medial().is_some() || q.medial().is_some())
}

/// Pairs of colliders whose boxes over the whole step meet, in the narrow phase's order (lower collider
/// index first). Of rapier's own shapes only those count that are near medial ones, and of fixed colliders those near
/// what moves: a world may have thousands of either.
pub fn sweep(view: &StepView, dt: Real, margin: Real) -> Vec<[usize; 2]> {
    let swept = |k: usize| {
        let aabb = view.swept_aabb(k, 0.0, dt);
        (k, aabb.loosened(margin + view.colliders[k].skin))
    };
    let mut parts: Vec<(usize, Aabb)> = (0..view.colliders.len()).map(swept).collect();
    keep_near(&mut parts, |k| view.colliders[k].medial().is_some());
    keep_near(&mut parts, |k| {
        view.bodies[view.colliders[k].body].mobility != Mobility::Fixed
    });
    let (parts, boxes): (Vec<usize>, Vec<Aabb>) = parts.into_iter().unzip();
    let met = overlapping_pairs(&boxes)
        .into_iter()
        .map(|pair| pair.map(|n| parts[n]));
    let is_ccd_candidate = met.filter(|pair| is_ccd_candidate(view, *pair));
    let mut pairs: Vec<_> = is_ccd_candidate.map(|pair| in_order(view, pair)).collect();
    pairs.sort_unstable();
    pairs
}

/// Keeps the boxes of parts that are wanted, and those that meet the box round all of these. A box that is not a number
/// meets nothing.
fn keep_near(parts: &mut Vec<(usize, Aabb)>, is_wanted: impl Fn(usize) -> bool) {
    let is_number = |b: &Aabb| !b.mins.is_nan() && !b.maxs.is_nan();
    let wanted = parts.iter().filter(|(k, b)| is_wanted(*k) && is_number(b));
    let all = wanted.fold(Aabb::new_invalid(), |all, (_, b)| all.merged(b));
    parts.retain(|(k, b)| is_wanted(*k) || b.intersects(&all));
}

/// The two in the narrow phase's order.
pub fn in_order(view: &StepView, [i, j]: [usize; 2]) -> [usize; 2] {
    let index = |k: usize| view.colliders[k].handle.into_raw_parts().0;
    if index(i) <= index(j) { [i, j] } else { [j, i] }
}

#[cfg(test)]
mod tests {
    use super::keep_near;
    use crate::math::{Real, Vector};
    use parry3d::bounding_volume::Aabb;

    #[test]
    fn boxes_near_wanted_ones_are_kept_beside_one_that_is_no_number() {
        let cube = |from: Real, to: Real| Aabb::new(Vector::splat(from), Vector::splat(to));
        let boxes = [
            cube(0.0, 1.0),
            cube(Real::NAN, Real::NAN),
            cube(0.5, 2.0),
            cube(5.0, 6.0),
        ];
        let mut parts: Vec<(usize, Aabb)> = boxes.into_iter().enumerate().collect();
        keep_near(&mut parts, |k| k < 2);
        let kept: Vec<usize> = parts.iter().map(|(k, _)| *k).collect();
        assert_eq!(kept, [0, 1, 2]);
    }
}
