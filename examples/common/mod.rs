//! What the examples share: meshes made in code, a small renderer, checks against the true shapes.
//! Each example uses a part of it.
#![allow(dead_code)]

pub mod animation;
pub mod arguments;
pub mod audit;
pub mod build;
pub mod creature;
pub mod decimate;
pub mod falling;
pub mod font;
pub mod isosurface;
pub mod light;
pub mod mesh;
pub mod pillars;
pub mod progress;
pub mod random;
pub mod render;
pub mod scene;
pub mod scene_strip;
pub mod scene_table;
pub mod screw;
pub mod shape_error;
pub mod skeleton;
pub mod skin;
pub mod strip;
pub mod surface_error;
pub mod surfaces;
pub mod table;
pub mod threading;
pub mod triangle_toi;
