//! Bodies of five shapes are thrown into pillars 5 mm thin, as in the paper's "Multi-bodies"
//! benchmark (Figures 5 and 9). They travel up to 45 pillar widths in a step, and none may pass
//! through a pillar or through another body.
//!
//! ```text
//! cargo run --release --example thin_pillars
//! ```
//! Option: `--out DIR` (where the picture goes; default target/thin_pillars).
//!
//! Exits with 1 when a medial body's inner lines cross a pillar's axis or another body's lines, on
//! the way from pose to pose. Lines and axes are those of the formulas that the bodies were made of. In the end
//! none may be under the ground.

mod common;

use common::arguments::{example_with_out, verdict};
use common::pillars::field;
use common::render::Camera;
use common::scene::Kind;
use common::scene_strip::View;
use common::scene_table::table;
use rapier3d::prelude::*;
use std::path::Path;
use std::process::ExitCode;

const STEPS: usize = 100;

fn main() -> ExitCode {
    example_with_out("target/thin_pillars", thin_pillars)
}

fn thin_pillars(out: &Path) -> Result<(), String> {
    let scene = field(0.014, 200)?;
    let runs = [Kind::Medial, Kind::Triangles].map(|kind| scene.run(kind, STEPS, |_, _| ()));
    let view = View {
        camera: Camera {
            eye: Vector::new(1.9, 2.3, 3.9),
            target: Vector::new(0.0, 0.75, 0.0),
            field_of_view: 0.62,
            shadows: 3.0,
        },
        tile: [440, 440],
        steps: &[10, 30, STEPS],
        ghost: 0.0,
    };
    let path = out.join("thin_pillars.png");
    view.strip(&scene, &[&runs[0], &runs[1]]).save(&path)?;
    println!("{}\n\n{}", path.display(), table(&[&runs[0], &runs[1]]));
    let audit = &runs[0].audit;
    let mut failures = Vec::new();
    if audit.crossings > 0 {
        failures.push(format!("inner lines crossed {} times", audit.crossings));
    }
    if !audit.finite || audit.lowest_last < -0.005 {
        failures.push(format!("lowest point in the end: {} m", audit.lowest_last));
    }
    verdict(failures)
}
