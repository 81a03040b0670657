//! Contacts of a step, planned before rapier's step: for which pairs rapier will ask, how far to look, where bodies
//! will be, and which pairs are muted, that is kept from its solver.
//!
//! - Which pairs: `candidates.rs`, `hanging.rs` and `outnumbered.rs` (computed anew though they hardly moved),
//!   `muting.rs` (none for rapier).
//! - How far to look: `reach.rs`, with `neighbor_speeds.rs`.
//! - At which poses: `predicted_contacts.rs`.
//! - Which contacts cannot move a body with locked axes: `locked_bodies.rs`.
//!
//! The contacts themselves are computed by [`crate::batch`]; [`crate::parry`] makes manifolds of them.

pub(crate) mod candidates;
pub(crate) mod hanging;
pub(crate) mod locked_bodies;
pub(crate) mod muting;
pub(crate) mod neighbor_speeds;
pub(crate) mod outnumbered;
pub(crate) mod predicted_contacts;
pub(crate) mod reach;
