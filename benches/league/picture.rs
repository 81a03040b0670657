//! The ends of one heap of thrown rings beside each other: rings that are linked otherwise than at the start are red.

use crate::common::light::facets;
use crate::common::mesh::ring;
use crate::common::render::Camera;
use crate::common::scene_strip::View;
use crate::common::strip::tile;
use crate::record::{Run, STATE};
use crate::scenes::{League, RING};
use crate::verdict::changed;
use rapier3d::math::{Pose, Rotation, Vector};
use std::path::Path;

/// The scene that is drawn, its first seed.
const SCENE: &str = "heap 60";
/// A setting that is left out: it ends like another one of rapier.
const ALIKE: &str = "compound";
/// Tiles in a row.
const COLUMNS: usize = 3;

/// Draws all runs.
pub fn draw(league: &League, runs: &[Run], path: &Path) -> Result<(), String> {
    let Some(drawn) = league.worlds.iter().position(|w| w.scene == SCENE) else {
        return Err(format!("no scene {SCENE}"));
    };
    let world = &league.worlds[drawn];
    let floor = Vector::Y * world.room[1] as f32;
    let mesh = ring(RING[0] as f32, RING[1] as f32, 48, 12);
    let view = View {
        camera: Camera {
            eye: Vector::new(0.0, 12.0, 17.0),
            target: Vector::new(0.0, 0.5, 0.0),
            field_of_view: 0.6,
            shadows: 8.0,
        },
        tile: [480, 300],
        steps: &[],
        ghost: 0.0,
    };
    let mut tiles = Vec::new();
    for run in runs.iter().filter(|r| r.setting != ALIKE) {
        let trajectory = &run.worlds[drawn];
        let pairs = changed(world, trajectory);
        let frame = trajectory.frames.last().ok_or("a run without frames")?;
        let mut seen = Vec::new();
        for (k, body) in frame.chunks_exact(STATE).enumerate() {
            let number = |i: usize| body[i].unwrap_or(f64::NAN) as f32;
            let at = Vector::new(number(0), number(1), number(2)) + floor;
            let turn = Rotation::from_xyzw(number(3), number(4), number(5), number(6));
            let color = match pairs.iter().any(|p| p.contains(&k)) {
                true => Vector::new(0.85, 0.08, 0.05),
                false => Vector::new(0.35, 0.5, 0.65),
            };
            if at.is_finite() && turn.is_finite() {
                seen.extend(facets(&mesh, Pose::from_parts(at, turn), color));
            }
        }
        let name = format!("{}: {}", run.engine, run.setting).to_uppercase();
        let count = format!("{} PAIRS WENT THROUGH EACH OTHER", pairs.len());
        tiles.push(view.labelled(&seen, &[&name, &count]));
    }
    while !tiles.len().is_multiple_of(COLUMNS) {
        tiles.push(view.labelled(&[], &[]));
    }
    let rows: Vec<_> = tiles.chunks(COLUMNS).map(<[_]>::to_vec).collect();
    tile(&rows).save(path)
}
