//! Whole rapier scenes: what rests, what hangs, what must never pass; saving, drawing, repeating.

mod after_blows;
#[path = "../common/blocks.rs"]
mod blocks;
mod bodies;
mod bounces;
mod brickwork;
mod budget;
mod bystanders;
mod carried_characters;
mod changed_shapes;
mod changes;
mod characters;
mod combs;
mod controls;
mod creature_walks;
mod crowds;
mod determinism;
mod dolls;
#[cfg(feature = "debug-render")]
mod drawing;
mod driven;
mod driven_crowds;
mod effects;
mod endurance;
mod energy;
mod eulers_disc;
mod fast_pairs;
mod features;
mod feet;
mod filters;
mod fixed_partners;
mod fixtures;
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
mod heavy_blows;
mod heavy_loads;
mod heavy_on_light;
mod held;
mod impact_laws;
mod impacts;
mod knots;
mod length_units;
mod let_go;
mod level_grounds;
mod limits;
mod linking;
mod local_thickness;
mod lock_box;
mod locked_axes;
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
mod pressed_rings;
mod put_in_place;
mod random;
mod resting;
mod restitution;
#[allow(dead_code)]
#[path = "../common/ccd/rng.rs"]
mod rng;
mod rolling;
mod ropes;
#[cfg(feature = "serde-serialize")]
mod saved_impacts;
#[cfg(feature = "serde-serialize")]
mod saving;
mod sharp_blocks;
mod sliding;
mod small_bodies;
#[allow(dead_code)]
#[path = "../../examples/factory/solid.rs"]
mod solid;
mod spawned;
mod stairs;
mod still;
mod strained_joints;
mod struck_links;
mod table_edges;
mod tapered;
#[allow(dead_code)]
#[path = "../../examples/factory/thread.rs"]
mod thread;
mod threads;
mod told;
mod triangles;
mod two_hands;
mod walls;
mod wheels;
mod whirls;
mod wire_heaps;
mod wires;
mod wrecking_ball;
