//! Workarounds of rapier 0.36, one file each. `docs/host.md` lists them, with the test that tells when one is no
//! longer needed.

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
