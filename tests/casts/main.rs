//! Shape casts of medial meshes against every built-in shape, by [`oracle`], which shares no code with
//! them.

mod compounds;
mod contact_reduction;
mod deep_contacts;
mod faces;
mod flat;
mod inside;
mod linear;
mod oracle;
#[allow(dead_code)]
#[path = "../common/ccd/rng.rs"]
mod rng;
mod rolling;
mod rotating;
mod shallow;
mod shapes;
mod small;
mod small_manifolds;
mod solid;
mod table;
mod terrain;
mod thin;
mod touching;
mod turns;
mod way_out;
mod within;
