//! View of the world that a step is taken with, made before rapier's step: bodies and their motions, colliders, who may
//! meet whom.
//!
//! - The view itself: `step_view.rs`, of bodies (`motion.rs`, `body_velocity.rs`), links of multibodies
//!   (`link_angles.rs`, `link_velocity.rs`), colliders and joints (`all_joints.rs`, `joint_opening.rs`, `groups.rs`);
//!   medial ones: `medial_colliders.rs`.
//! - Who may meet whom: `eligible_pairs.rs`, `filter_answers.rs` (hooks of the user), `enabled.rs`,
//!   `overlapping_boxes.rs`. Who is too far from all that moves: `participants.rs`, found by `near_what_moves.rs` among
//!   `still_colliders.rs`; what if something gets to them after all: `completed.rs`.
//! - How fast they meet: `meeting_speed.rs`. How they resist: `inertia.rs`. Whether there is anything to do:
//!   `census.rs`.

pub(crate) mod all_joints;
pub(crate) mod body_velocity;
pub(crate) mod census;
mod completed;
pub(crate) mod eligible_pairs;
pub(crate) mod enabled;
pub(crate) mod filter_answers;
pub(crate) mod groups;
pub(crate) mod inertia;
pub(crate) mod joint_opening;
pub(crate) mod link_angles;
pub(crate) mod link_velocity;
pub(crate) mod medial_colliders;
pub(crate) mod meeting_speed;
pub(crate) mod motion;
pub(crate) mod near_what_moves;
pub(crate) mod overlapping_boxes;
pub(crate) mod participants;
pub(crate) mod step_view;
pub(crate) mod still_colliders;
