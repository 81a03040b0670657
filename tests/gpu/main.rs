//! Shaders and batches on a GPU. Without an adapter only the shaders are read, as text, and the
//! others say SKIP; `MEDIAL_REQUIRE_GPU=1` makes a missing adapter a failure.

#[allow(
    dead_code,
    reason = "the judge of the queries' tests; here its queries and its oracle serve"
)]
#[path = "../common/ccd/mod.rs"]
mod ccd;

#[allow(dead_code, reason = "the creature; its scenes belong to other tests")]
#[path = "../common/creature.rs"]
mod creature;

#[allow(dead_code, reason = "all forms serve other tests")]
#[path = "../common/detailed.rs"]
mod detailed;

mod allocations;
mod bare;
mod batch;
mod calibration;
mod culling;
mod early;
mod elementary;
mod failures;
mod large;
mod lists;
mod scene;
mod shaders;
mod worlds;
