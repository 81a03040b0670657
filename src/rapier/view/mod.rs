//! View of the world that a step is taken with, made before rapier's step: bodies and their motions, colliders, who may
//! meet whom.

pub(crate) mod census;
pub(crate) mod eligible_pairs;
pub(crate) mod enabled;
pub(crate) mod filter_answers;
pub(crate) mod inertia;
pub(crate) mod link_angles;
pub(crate) mod medial_colliders;
pub(crate) mod meeting_speed;
pub(crate) mod motion;
pub(crate) mod overlapping_boxes;
pub(crate) mod step_view;
