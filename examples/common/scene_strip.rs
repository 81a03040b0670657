//! The scene in pictures: a column for each moment, a row for each run.

use super::light::{Facet, facets};
use super::progress::bar;
use super::render::{Camera, Image, render};
use super::scene::{Run, Scene};
use super::strip::tile;
use rapier3d::prelude::{Real, Vector};
use std::f32::consts::TAU;
use std::thread;

/// Draws the true meshes after the steps `shown` (or at the end, where a run had fewer), tiles
/// `width` pixels wide.
pub fn draw(scene: &Scene, runs: &[(&str, &Run)], shown: &[usize], width: usize) -> Image {
    let bar = bar("render", runs.len() * shown.len());
    let row = |(name, run): &(&str, &Run)| {
        let moments = shown.iter().map(|step| {
            let image = picture(scene, name, run, *step, width);
            bar.inc(1);
            image
        });
        moments.collect()
    };
    let rows: Vec<Vec<Image>> = thread::scope(|scope| {
        let threads: Vec<_> = runs.iter().map(|run| scope.spawn(|| row(run))).collect();
        let joined = threads.into_iter().map(|t| t.join().expect("a drawn row"));
        joined.collect()
    });
    bar.finish();
    tile(&rows)
}

fn picture(scene: &Scene, name: &str, run: &Run, step: usize, width: usize) -> Image {
    let camera = Camera {
        eye: Vector::new(3.4, 4.4, 7.6),
        target: Vector::new(0.1, 1.2, 0.1),
        field_of_view: 0.66,
    };
    let bodies = run.poses_after(step).iter().enumerate();
    let seen: Vec<Facet> = bodies
        .flat_map(|(body, pose)| facets(&scene.model(body).mesh, *pose, color(scene, body)))
        .collect();
    let mut image = render(&camera, &seen, width, width * 5 / 6);
    let dot = width / 240;
    image.label(name, [6 * dot, 6 * dot], dot);
    let step = step.min(run.milliseconds.len());
    image.label(&format!("STEP {step}"), [6 * dot, 15 * dot], dot);
    image
}

/// Rings in the colours of the rainbow, the creature in slate.
fn color(scene: &Scene, body: usize) -> Vector {
    let rings = scene.starts.len();
    if body == rings {
        return Vector::new(0.20, 0.22, 0.27);
    }
    let hue = TAU * body as Real / rings as Real;
    let share = |k: Real| (0.45 + 0.45 * (hue - k * TAU / 3.0).cos()).powf(1.5);
    Vector::new(share(0.0), share(1.0), share(2.0))
}
