//! Impacts within a step: the queue of pairs, their first contacts, and what an impact does to bodies.

pub(crate) mod body_state;
mod bounces;
mod contact_impulses;
pub(crate) mod contact_point;
pub(crate) mod deep_pairs;
pub(crate) mod event_loop;
pub(crate) mod event_queue;
pub(crate) mod fast_parts;
pub(crate) mod impact_history;
pub(crate) mod impulse;
pub(crate) mod initial_overlaps;
pub(crate) mod lazy_toi_query;
mod lost_gains;
mod near_lists;
pub(crate) mod outcome;
pub(crate) mod pair_culling;
pub(crate) mod response;
pub(crate) mod spent_budget;
pub(crate) mod swept_boxes;
pub(crate) mod toi_query;
pub(crate) mod way_out;
