//! The tests of `docs/rapier.md`, feature by feature: medial colliders beside rapier's own in whole scenes.

mod after_blows;
mod bent_grounds;
#[allow(dead_code)]
#[path = "../common/blocks.rs"]
mod blocks;
#[path = "../common/bodies.rs"]
mod bodies;
mod bounces;
mod brickwork;
mod budget;
mod bystanders;
mod carried_characters;
mod changed_shapes;
mod changes;
mod characters;
mod controls;
mod creature_walks;
mod crowds;
mod cups;
mod determinism;
mod dolls;
#[path = "../common/dominoes.rs"]
mod dominoes;
#[cfg(feature = "debug-render")]
mod drawing;
mod driven;
mod effects;
mod endurance;
mod energy;
mod fast_pairs;
mod features;
mod feet;
mod filters;
mod fixed_partners;
mod flat_falls;
mod folds;
mod force_events;
mod found;
#[cfg_attr(
    not(feature = "enhanced-determinism"),
    allow(dead_code, reason = "the golden holds with that feature only")
)]
#[path = "../common/golden.rs"]
mod golden;
mod grasps;
mod hanging;
mod hanging_limits;
mod heaps;
mod held;
mod impacts;
mod knots;
mod length_units;
mod let_go;
mod level_grounds;
mod limits;
#[path = "../common/linking.rs"]
mod linking;
mod local_thickness;
mod locked_axes;
mod locked_in_contact;
mod medial_floors;
mod modified;
mod multibodies;
mod muted;
mod neighbours;
mod new_links;
mod odd_steps;
mod oneway;
mod oracle;
mod outnumbered;
mod partners;
mod pinched;
mod posts;
mod put_in_place;
#[path = "../common/random.rs"]
mod random;
mod resting;
mod restitution;
#[allow(dead_code)]
#[path = "../common/ccd/rng.rs"]
mod rng;
mod rolling;
mod ropes;
#[cfg(feature = "serde-serialize")]
mod saved_changes;
#[cfg(feature = "serde-serialize")]
mod saved_impacts;
#[cfg(feature = "serde-serialize")]
mod saving;
mod seams;
mod sliding;
mod small_bodies;
mod spawned;
mod stairs;
mod still;
mod strained_joints;
mod struck_links;
mod table_edges;
mod tapered;
mod told;
mod triangles;
mod two_hands;
mod walls;
mod wheels;
mod whirls;
