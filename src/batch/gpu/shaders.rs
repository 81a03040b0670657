//! The source texts of the shaders, put together from one file for each stage and for each shared piece of maths,
//! without a preprocessor. No GPU is needed for that, so a test parses, validates and translates each of them.

use super::layout::{STRUCTS, constants};

/// Source of one module and its entry points.
pub struct Module {
    /// Name of the stage's file.
    pub name: &'static str,
    files: &'static [&'static str],
    /// Entry points, and the bindings that each uses.
    pub stages: &'static [(&'static str, &'static [usize])],
}

impl Module {
    /// The whole WGSL text: constants, structs, shared maths, stage.
    pub fn source(&self) -> String {
        constants() + STRUCTS + &self.files.concat()
    }
}

/// A batch of elementary tests.
pub const ELEMENTARY: Module = Module {
    name: "elementary",
    files: &[
        include_str!("../../../shaders/texels.wgsl"),
        include_str!("../../../shaders/nearest.wgsl"),
        include_str!("../../../shaders/elementary.wgsl"),
    ],
    stages: &[("cones", &[0, 1, 2]), ("slabs", &[0, 1, 2])],
};

/// A batch of mesh pairs.
pub const CULL: Module = Module {
    name: "cull",
    files: &[
        include_str!("../../../shaders/texels.wgsl"),
        include_str!("../../../shaders/swept.wgsl"),
        include_str!("../../../shaders/cull.wgsl"),
    ],
    stages: &[("walk", &[0, 1, 2, 4, 6]), ("prove", &[0, 1, 3, 4, 5, 6])],
};

/// All of them.
pub const MODULES: [Module; 2] = [ELEMENTARY, CULL];
