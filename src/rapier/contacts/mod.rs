//! Contacts that rapier will ask for: which pairs, how far to look, where bodies will be.

pub(crate) mod candidates;
pub(crate) mod hanging;
pub(crate) mod muting;
pub(crate) mod neighbor_speeds;
pub(crate) mod predicted_contacts;
pub(crate) mod reach;
