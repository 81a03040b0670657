//! Whole rapier scenes: what rests, what hangs, what must never pass.

mod bodies;
mod resting;
mod walls;
