//! Impacts within a step, resolved after rapier's step: the queue of pairs, their first contacts, and what an impact
//! does to bodies.
//!
//! - The loop: `event_loop.rs`, in the order of times of `event_queue.rs`; its result: `outcome.rs`.
//! - When a pair first touches: `toi_query.rs` (what counts as contact; its answer `hit.rs`), `lazy_toi_query.rs` (a
//!   search that pauses).
//! - Which pairs are searched at all: `fast_parts.rs`, `deep_pairs.rs`, `initial_overlaps.rs`, `pinched.rs`; what
//!   spares a search: `swept_boxes.rs`, `path_boxes.rs`, `pair_culling.rs`, `near_lists.rs`.
//! - What an impact does: `impulse.rs` is the law (Newton's restitution, Coulomb's friction), `contact_impulses.rs`
//!   gives the two impulses of one contact (where it acts: `contact_point.rs`, `center_of_pressure.rs`), `response.rs`
//!   passes them on to what touches already, as far as `impact_history.rs` knows; `bounces.rs`, `way_out.rs` and
//!   `lost_gains.rs` say with which speeds.
//! - Bodies with too many impacts: `body_state.rs`; steps whose budget is spent: `spent_budget.rs`.

pub(crate) mod body_state;
mod bounces;
mod center_of_pressure;
mod contact_impulses;
pub(crate) mod contact_point;
pub(crate) mod deep_pairs;
pub(crate) mod event_loop;
pub(crate) mod event_queue;
pub(crate) mod fast_parts;
pub(crate) mod hit;
pub(crate) mod impact_history;
pub(crate) mod impulse;
pub(crate) mod initial_overlaps;
pub(crate) mod lazy_toi_query;
mod lost_gains;
mod near_lists;
pub(crate) mod outcome;
pub(crate) mod pair_culling;
pub(crate) mod path_boxes;
mod pinched;
pub(crate) mod response;
pub(crate) mod spent_budget;
pub(crate) mod swept_boxes;
pub(crate) mod toi_query;
pub(crate) mod way_out;
