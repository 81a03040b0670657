//! The shaders: one file per stage and per shared maths file, put together without a preprocessor.
//! They need no GPU to be read, so a test parses, validates and translates each of them.

use super::layout::{STRUCTS, constants};

/// Source of one module and its entry points.
pub struct Module {
    /// Name of the stage's file.
    pub name: &'static str,
    files: &'static [&'static str],
    /// Entry points.
    pub stages: &'static [&'static str],
}

impl Module {
    /// The whole WGSL text: constants, structs, shared maths, stage.
    pub fn source(&self) -> String {
        if let Ok(dir) = std::env::var("MEDIAL_SHADERS") {
            if let Ok(t) = std::fs::read_to_string(format!("{dir}/{}.wgsl", self.name)) {
                return t;
            }
        }
        constants() + STRUCTS + &self.files.concat()
    }
}

/// A batch of elementary tests.
pub const ELEMENTARY: Module = Module {
    name: "elementary",
    files: &[
        include_str!("../../../shaders/nearest.wgsl"),
        include_str!("../../../shaders/elementary.wgsl"),
    ],
    stages: &["cones", "slabs"],
};

/// Mesh pairs to primitive pairs that are not proven free.
pub const CULL: Module = Module {
    name: "cull",
    files: &[
        include_str!("../../../shaders/swept.wgsl"),
        include_str!("../../../shaders/cull.wgsl"),
    ],
    stages: &["walk"],
};

/// All of them.
pub const MODULES: [Module; 2] = [ELEMENTARY, CULL];
