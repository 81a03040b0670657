//! Elementary queries, judged by an independent oracle; and the oracle, judged by closed forms.

#[path = "../common/blocks.rs"]
mod blocks;
#[path = "../common/ccd/mod.rs"]
mod ccd;
#[path = "../common/creature.rs"]
mod creature;

/// What the examples take for the truth.
#[allow(dead_code)]
#[path = "../../examples/common"]
mod truth_of_examples {
    pub mod mesh;
    pub mod triangle_toi;
}

mod bad_input;
mod batch;
mod coherence;
mod convex_contacts;
mod convex_pieces;
mod deep_in_pieces;
mod deepening;
mod detail;
#[path = "../common/detailed.rs"]
mod detailed;
mod distance;
mod effort;
mod extremes;
mod families;
mod first_contact;
mod fuzz;
mod held_back;
mod judge;
mod lanes;
mod listed;
mod many_contacts;
mod meshes;
mod near_blocks;
mod near_pairs;
mod oracle;
mod outlines;
mod penetration;
mod regressions;
mod spinning_pieces;
mod thinned;
mod tips;
mod truth;
mod witness;
