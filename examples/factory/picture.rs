//! The nut on its bolt in a picture, at the start, half way and in the end; a millimetre is drawn as a tenth of a
//! metre.

use super::common::light::facets;
use super::common::mesh::Mesh;
use super::common::render::Camera;
use super::common::scene_strip::{SLATE, View};
use super::common::strip::tile;
use super::nut::Descent;
use super::thread::{Part, Thread};
use rapier3d::prelude::*;
use std::path::Path;

const SCALE: Real = 100.0;

fn drawn(thread: &Thread, part: Part, heights: [f64; 2]) -> Mesh {
    let made = thread.triangles(part, heights, 96);
    Mesh {
        vertices: made.vertices.iter().map(|v| *v * SCALE).collect(),
        indices: made.indices,
    }
}

/// Draws the nut after so many steps.
pub fn nut(thread: &Thread, descent: &Descent, out: &Path) -> Result<(), String> {
    let low = -4.0 * thread.pitch - thread.nut[0];
    let half = 0.5 * thread.nut[0];
    let bolt = drawn(thread, Part::Bolt, [low, thread.nut[0]]);
    let nut = drawn(thread, Part::Nut, [-half, half]);
    let lift = Vector::Y * (-low as Real * SCALE);
    let view = View {
        camera: Camera {
            eye: Vector::new(4.0, 6.0, 10.0),
            target: lift * 0.8,
            field_of_view: 0.5,
            shadows: 6.0,
        },
        tile: [300, 400],
        steps: &[],
        ghost: 0.0,
    };
    let last = descent.poses.len() - 1;
    let tiles = [0, last / 2, last].map(|step| {
        let pose = descent.poses[step];
        let pose = Pose::from_parts(pose.translation * SCALE + lift, pose.rotation);
        let bolt = facets(&bolt, Pose::from_translation(lift), SLATE);
        let nut = facets(&nut, pose, Vector::new(0.85, 0.55, 0.12));
        let seen: Vec<_> = bolt.chain(nut).collect();
        view.labelled(&seen, &[thread.name, &format!("STEP {}", step + 1)])
    });
    let path = out.join("factory.png");
    tile(&[tiles.to_vec()]).save(&path)?;
    println!("{}", path.display());
    Ok(())
}
