//! `medial info --curve`: the error of a triangle mesh at several numbers of primitives.

use crate::STOP;
use crate::build::{BAR_STEPS, bar, listen};
use crate::describe::{Errors, relative};
use crate::failure::Failure;
use crate::info::InfoArguments;
use crate::output::print;
use rapier3d_medial::BuildOptions;
use rapier3d_medial::meshing::error_curve;
use rapier3d_medial::meshing::mesh_file::{self, MeshFormat};
use serde::Serialize;
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

/// The error at a count of primitives.
#[derive(Serialize)]
struct Point {
    asked: usize,
    primitives: usize,
    /// The larger of both directions (longest side 1).
    error: f32,
    errors: Errors,
}

/// The output of `info --curve`.
#[derive(Serialize)]
struct Curve {
    longest_side: f32,
    points: Vec<Point>,
}

/// Prints the error at each count.
pub fn curve(arguments: &InfoArguments) -> Result<(), Failure> {
    let path = &arguments.mesh;
    if path.is_file() && MeshFormat::of(path).is_none() {
        return Err(Failure::NoTriangleMesh(path.clone()));
    }
    let mut source = mesh_file::read(path).map_err(|e| Failure::from(e).of(path))?;
    arguments.placing.place(&mut source);
    let options = BuildOptions {
        quality: arguments.quality.into(),
        enclose: !arguments.no_enclose,
        ..Default::default()
    };
    let counts: Vec<usize> = arguments.counts.iter().map(|&n| n as usize).collect();
    listen();
    let bar = bar(1, false);
    let (points, side) = error_curve(
        &source.vertices,
        &source.indices,
        &counts,
        &options,
        &mut |progress| {
            bar.set_message(progress.stage);
            bar.set_position((progress.fraction * BAR_STEPS as f32) as u64);
            match STOP.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        },
    )
    .map_err(|e| Failure::from(e).of(path))?;
    bar.finish_and_clear();
    let point = |at: &rapier3d_medial::meshing::ErrorAt| Point {
        asked: at.asked,
        primitives: at.primitives,
        error: at.hausdorff.error() / side,
        errors: relative(&at.hausdorff, side),
    };
    let curve = Curve {
        longest_side: side,
        points: points.iter().map(point).collect(),
    };
    print(arguments.json, &curve, || curve.text())
}

impl Curve {
    fn text(&self) -> String {
        let mut text = format!(
            "error by number of primitives; the mesh's longest side is {}\n\
             at most     error/side   error        primitives\n",
            self.longest_side
        );
        for point in &self.points {
            text += &format!(
                "{:<11} {:<12.6} {:<12.4e} {}\n",
                point.asked,
                point.error,
                point.error * self.longest_side,
                point.primitives
            );
        }
        text
    }
}
