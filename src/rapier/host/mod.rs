//! Workarounds of rapier 0.36, one file each. `docs/host.md` lists them, with the test that tells when one is no
//! longer needed.
//!
//! - Contacts that rapier keeps: which ones (`recycling.rs`), how deep they are now (`contact_depth.rs`), and how it is
//!   made to compute them anew (`forced_updates.rs`).
//! - What bodies are given for the length of rapier's step: more sub-steps (`substeps.rs`), shorter times before
//!   they sleep (`sleep_timers.rs`), speculative contacts (`speculative.rs`).
//! - Multibodies: those that gain energy (`multibody_energy.rs`), how impacts are written back to them
//!   (`multibody_coordinates.rs`), and bodies that a new joint moves (`new_links.rs`).
//! - What was changed in a collider: `change_marks.rs`.
//! - Events of impacts: `events_of_impacts.rs`, with their impulses `reported_impulse.rs`.

pub(crate) mod change_marks;
pub(crate) mod contact_depth;
pub(crate) mod events_of_impacts;
pub(crate) mod forced_updates;
pub(crate) mod multibody_coordinates;
pub(crate) mod multibody_energy;
pub(crate) mod new_links;
pub(crate) mod recycling;
pub(crate) mod reported_impulse;
pub(crate) mod sleep_timers;
pub(crate) mod speculative;
pub(crate) mod substeps;
