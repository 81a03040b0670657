//! Scenes that are hard on any physics engine: heavy bodies on light ones, wire without thickness, threads with a tenth
//! of a millimetre of play, nets of chain, crowds that a wall sweeps along.

#[path = "../common/blocks.rs"]
mod blocks;
#[allow(dead_code)]
#[path = "../common/bodies.rs"]
mod bodies;
#[path = "../common/combs.rs"]
mod combs;
mod driven_crowds;
mod eulers_disc;
mod fixtures;
mod heavy_blows;
mod heavy_loads;
mod heavy_on_light;
mod impact_laws;
#[path = "../common/linking.rs"]
mod linking;
mod lock_box;
mod pressed_rings;
#[path = "../common/random.rs"]
mod random;
#[allow(dead_code)]
#[path = "../common/ccd/rng.rs"]
mod rng;
mod sharp_blocks;
#[allow(dead_code)]
#[path = "../../examples/factory/solid.rs"]
mod solid;
#[allow(dead_code)]
#[path = "../../examples/factory/thread.rs"]
mod thread;
mod threads;
mod wire_heaps;
mod wires;
mod wrecking_ball;
