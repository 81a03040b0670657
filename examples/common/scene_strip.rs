//! Runs of a scene in pictures: a column for each moment, a row for each run.

use super::light::{Facet, facets};
use super::mesh::ball;
use super::progress::bar;
use super::render::{Camera, Image, render};
use super::scene::{Kind, Run, Scene};
use super::strip::tile;
use rapier3d::prelude::{Pose, Real, Vector};
use std::f32::consts::TAU;
use std::thread;

/// Dark, for what stands.
pub const SLATE: Vector = Vector::new(0.20, 0.22, 0.27);
/// Of ghost contacts.
const GHOST: Vector = Vector::new(1.0, 0.05, 0.03);

/// How a scene is seen.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// From where.
    pub camera: Camera,
    /// Width and height of a tile, in pixels.
    pub tile: [usize; 2],
    /// The moments to show, in steps; a run that was over earlier shows its end.
    pub steps: &'a [usize],
    /// Radius of the red balls that mark ghost contacts; 0 for none.
    pub ghost: Real,
}

impl View<'_> {
    /// Draws the true meshes: a row for each run, or the runs side by side where one moment is shown.
    pub fn strip(&self, scene: &Scene, runs: &[&Run]) -> Image {
        let bar = bar("render", runs.len() * self.steps.len());
        let row = |run: &Run| {
            let moments = self.steps.iter().map(|step| {
                let image = self.picture(scene, run, *step);
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
        match self.steps {
            [_] => tile(&[rows.concat()]),
            _ => tile(&rows),
        }
    }

    /// Draws one run, so many moments in a row.
    pub fn columns(&self, scene: &Scene, run: &Run, columns: usize) -> Image {
        let draw = |step: &usize| self.picture(scene, run, *step);
        let row = |steps: &[usize]| steps.iter().map(draw).collect();
        tile(&self.steps.chunks(columns).map(row).collect::<Vec<_>>())
    }

    /// Draws the runs side by side, a frame for each moment.
    pub fn frames(&self, scene: &Scene, runs: &[&Run]) -> Vec<Image> {
        let bar = bar("render", self.steps.len());
        let frame = |step: &usize| {
            let image = thread::scope(|scope| {
                let draw = |run| scope.spawn(move || self.picture(scene, run, *step));
                let drawn: Vec<_> = runs.iter().map(|run| draw(run)).collect();
                let row = drawn.into_iter().map(|t| t.join().expect("a drawn tile"));
                tile(&[row.collect()])
            });
            bar.inc(1);
            image
        };
        let frames = self.steps.iter().map(frame).collect();
        bar.finish();
        frames
    }

    fn picture(&self, scene: &Scene, run: &Run, step: usize) -> Image {
        let step = step.min(run.milliseconds.len());
        let mut seen = seen(scene, run.poses_after(step));
        let mark = ball(self.ghost, 12);
        let marks = run.ghosts[step].iter().filter(|_| self.ghost > 0.0);
        seen.extend(marks.flat_map(|p| facets(&mark, Pose::from_translation(*p), GHOST)));
        self.labelled(&seen, &[run.kind.name(), &format!("STEP {step}")])
    }

    /// Draws facets under some lines of text.
    pub fn labelled(&self, seen: &[Facet], lines: &[&str]) -> Image {
        let [width, height] = self.tile;
        let mut image = render(&self.camera, seen, width, height);
        let dot = (width / 240).max(1);
        for (number, line) in lines.iter().enumerate() {
            image.label(line, [6 * dot, (6 + 9 * number) * dot], dot);
        }
        image
    }
}

/// The true meshes of all actors, somewhere.
pub fn seen(scene: &Scene, poses: &[Pose]) -> Vec<Facet> {
    let actors = scene.actors.iter().zip(poses);
    actors
        .flat_map(|(actor, pose)| facets(&actor.model.mesh, *pose, actor.color))
        .collect()
}

/// All bodies before the first step and after each, the earlier the paler.
pub fn exposures(scene: &Scene, kind: Kind, steps: usize) -> Vec<Facet> {
    let mut stage = scene.stage(kind);
    let mut seen = Vec::new();
    for step in 0..=steps {
        let fade = 0.75 * (1.0 - step as Real / steps as Real);
        for (actor, pose) in scene.actors.iter().zip(stage.poses()) {
            let color = actor.color.lerp(Vector::splat(0.8), fade);
            seen.extend(facets(&actor.model.mesh, pose, color));
        }
        stage.step();
    }
    seen
}

/// The colours of the rainbow, `share` in [0, 1] of the way round.
pub fn rainbow(share: Real) -> Vector {
    let hue = TAU * share;
    let part = |k: Real| (0.45 + 0.45 * (hue - k * TAU / 3.0).cos()).powf(1.5);
    Vector::new(part(0.0), part(1.0), part(2.0))
}
