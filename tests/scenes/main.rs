//! Whole rapier scenes: what rests, what hangs, what must never pass.

mod bodies;
mod fast_pairs;
mod heaps;
mod impacts;
mod oracle;
mod random;
mod resting;
mod walls;
