//! `--scale` and `--up`: how the coordinates of a triangle mesh's file are taken.

use crate::build::positive;
use clap::{Args, ValueEnum};
use rapier3d_medial::math::Vector;
use rapier3d_medial::meshing::mesh_file::TriangleMesh;

#[derive(Args)]
pub struct PlacingArguments {
    /// Multiply all lengths of the triangle mesh first: 0.001 turns millimetres into metres.
    #[arg(long, value_name = "S", value_parser = positive)]
    scale: Option<f32>,
    /// Which axis points up in the triangle mesh's file; z is turned to y.
    #[arg(long, value_enum, default_value_t)]
    up: Up,
}

/// The axis that points up.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum Up {
    /// The y axis, as in rapier's examples and glTF.
    #[default]
    Y,
    /// The z axis, as in CAD programs and Blender.
    Z,
}

impl PlacingArguments {
    /// Whether either was given, other than as it is by default.
    pub fn is_given(&self) -> bool {
        self.scale.is_some() || self.up != Up::Y
    }

    /// Turns and scales the vertices.
    pub fn place(&self, source: &mut TriangleMesh) {
        let scale = self.scale.unwrap_or(1.0);
        for v in &mut source.vertices {
            *v = scale
                * match self.up {
                    Up::Y => *v,
                    Up::Z => Vector::new(v.x, v.z, -v.y),
                };
        }
    }
}
