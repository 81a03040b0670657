//! Boxes round the paths of colliders in the event loop, and whether one gets to a collider that does not take part in
//! the step ([`crate::rapier::view::participants`]).

use crate::math::Real;
use crate::rapier::impacts::event_loop::Loop;
use crate::rapier::impacts::swept_boxes::SweptBoxes;
use crate::rapier::view::near_what_moves::MARGIN;
use parry3d::bounding_volume::{Aabb, BoundingVolume};

impl Loop<'_> {
    /// Box round the path of a collider from `time` to the end of the step.
    pub fn swept_box(&self, part: usize, time: Real) -> Aabb {
        self.grown(part, self.view.swept_aabb(part, time, self.policy.dt))
    }

    /// A box grown by as far as first contacts are looked for.
    pub fn grown(&self, part: usize, aabb: Aabb) -> Aabb {
        aabb.loosened(self.view.colliders[part].skin + MARGIN * self.policy.unit)
    }

    /// Finds the boxes of all colliders, before the first impact changes any.
    pub fn find_boxes(&mut self) {
        if self.boxes.is_empty() {
            let parts = 0..self.view.colliders.len();
            self.boxes = SweptBoxes::new(parts.map(|k| self.swept_box(k, 0.0)).collect());
            self.parts_of = vec![Vec::new(); self.view.bodies.len()];
            for (k, part) in self.view.colliders.iter().enumerate() {
                self.parts_of[part.body].push(k);
            }
        }
    }

    /// Whether a box meets that of a bystander.
    pub fn meets_bystander(&self, aabb: &Aabb) -> bool {
        let participants = self.participants;
        participants.is_some_and(|p| p.bystanders_in(aabb).next().is_some())
    }
}
