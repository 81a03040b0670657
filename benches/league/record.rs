//! What an engine makes of the scenes: the file that every engine's program writes.

use serde::{Deserialize, Serialize};

/// Numbers of a body in a frame: position, rotation (x, y, z, w), velocity, angular velocity, in the world's frame.
pub const STATE: usize = 13;

/// One world's steps.
#[derive(Default, Serialize, Deserialize)]
pub struct Trajectory {
    /// Milliseconds of processor time of each step.
    pub ms: Vec<f64>,
    /// States of all bodies in their order, `STATE` numbers each.
    pub frames: Vec<Vec<Option<f64>>>,
}

/// One engine with one setting, all worlds in their order.
#[derive(Serialize, Deserialize)]
pub struct Run {
    pub engine: String,
    pub version: String,
    pub setting: String,
    pub is_wasm: bool,
    pub worlds: Vec<Trajectory>,
}
