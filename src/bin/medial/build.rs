//! `medial build`: medial meshes from triangle meshes, with a progress bar and a report.

use crate::describe::{Description, Errors, describe, relative};
use crate::failure::{Failed, Failure};
use crate::jobs::{self, Job, plan};
use crate::lengths::{Length, Unit, UnitUnknown, longest_side};
use crate::output::{print, say};
use crate::placing::PlacingArguments;
use crate::{INTERRUPTED, STOP};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use rapier3d_medial::meshing::{Creases, mesh_file};
use rapier3d_medial::{BuildOptions, MedialMesh, Quality};
use serde::Serialize;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Steps of the progress bar (a count) for each mesh: one per mille.
pub const BAR_STEPS: u64 = 1000;

#[derive(Args)]
pub struct BuildArguments {
    /// Triangle meshes: obj, stl, ply, off, glb or gltf, or folders of them.
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    /// File to write: OUT.medial loads at once and has the mass of the triangle mesh, OUT.ma is text without
    /// mass. For several meshes, the folder to write into.
    #[arg(short, long, value_name = "OUT.medial")]
    output: PathBuf,
    /// Largest number of primitives: slabs, cones that belong to no slab, lone spheres
    /// [default: 500, or as many as --max-error needs].
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    primitives: Option<u32>,
    /// Largest distance between the surfaces of mesh and collider, as a fraction of the mesh's longest side. Without
    /// --primitives, the smallest medial mesh that keeps to it is built.
    #[arg(short = 'e', long, value_name = "E", value_parser = positive)]
    max_error: Option<f32>,
    /// Like --max-error, as a length: 0.02 is in the unit of the file; 0.02mm needs --unit, except
    /// for glTF.
    #[arg(long, value_name = "LENGTH", conflicts_with = "max_error")]
    tolerance: Option<Length>,
    /// The unit of the file (um, mm, cm, m, km, in, ft); glTF is in metres.
    #[arg(long, value_name = "UNIT", requires = "tolerance")]
    unit: Option<Unit>,
    /// How much work to spend on making the error small.
    #[arg(short, long, value_enum, default_value_t)]
    quality: QualityArgument,
    /// Fit the surface from both sides instead of covering it.
    #[arg(long)]
    no_enclose: bool,
    /// Round all edges, also where sharp ones would make the error smaller.
    #[arg(long)]
    round_edges: bool,
    /// Into a folder: write .medial files, which load at once, instead of .ma.
    #[arg(long)]
    bake: bool,
    #[command(flatten)]
    placing: PlacingArguments,
    /// Print nothing unless something fails.
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
}

/// [`Quality`], as an argument.
#[derive(Clone, Copy, Default, ValueEnum)]
pub enum QualityArgument {
    /// A fifth of the time, an error one and a half to three times as large, of some creatures six times, of
    /// thin-walled bodies thirty times.
    Fast,
    /// For most meshes.
    #[default]
    Balanced,
    /// Three times the time, for little gain.
    Best,
}

impl From<QualityArgument> for Quality {
    fn from(argument: QualityArgument) -> Self {
        match argument {
            QualityArgument::Fast => Self::Fast,
            QualityArgument::Balanced => Self::Balanced,
            QualityArgument::Best => Self::Best,
        }
    }
}

/// Which edges are kept.
pub fn creases(round_edges: bool) -> Creases {
    match round_edges {
        true => Creases::None,
        false => Creases::Auto,
    }
}

/// Summary of a build.
#[derive(Serialize)]
struct BuildSummary {
    #[serde(serialize_with = "crate::output::path")]
    output: PathBuf,
    vertices: usize,
    triangles: usize,
    mesh: Description,
    errors: Errors,
    errors_before_enclosure: Option<Errors>,
    longest_side: f32,
    target_reached: bool,
    notes: Vec<String>,
    seconds: Vec<(&'static str, f64)>,
}

/// One mesh of several.
#[derive(Serialize)]
#[serde(untagged)]
enum Built {
    Done(Box<BuildSummary>),
    Failed(Failed),
}

pub fn positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a positive number".into()),
    }
}

impl BuildArguments {
    /// The largest error as a length in the unit of a file.
    fn tolerance_in_unit_of(&self, path: &Path) -> Result<Option<f64>, UnitUnknown> {
        let tolerance = self.tolerance;
        tolerance.map(|t| t.in_unit_of(path, self.unit)).transpose()
    }
}

/// Builds and writes all meshes; one that fails is told, the others are built.
pub fn build(arguments: &BuildArguments) -> Result<(), Failure> {
    let jobs = plan(&arguments.inputs, &arguments.output, arguments.bake)?;
    for job in &jobs {
        arguments.tolerance_in_unit_of(&job.input)?;
    }
    listen();
    let bar = bar(jobs.len(), arguments.quiet);
    let mut summaries = Vec::new();
    let mut failed = 0;
    for (index, job) in jobs.iter().enumerate() {
        let start = BAR_STEPS * index as u64;
        let name = match jobs.len() {
            1 => String::new(),
            all => format!("{} of {all}, {}: ", index + 1, job.input.display()),
        };
        let show = |stage: &str, fraction: f32| {
            bar.set_message(format!("{name}{stage}"));
            bar.set_position(start + (fraction * BAR_STEPS as f32) as u64);
        };
        match build_one(job, arguments, show) {
            Ok(summary) if arguments.json => summaries.push(Built::Done(Box::new(summary))),
            Ok(_) if arguments.quiet => {}
            Ok(summary) => bar.suspend(|| print(false, &summary, || summary.text()))?,
            Err(failure) if jobs.len() == 1 || STOP.load(Ordering::Relaxed) => {
                bar.finish_and_clear();
                return Err(failure.of(&job.input));
            }
            Err(failure) => {
                let failure = failure.of(&job.input);
                bar.suspend(|| say(&failure));
                failed += 1;
                summaries.push(Built::Failed(Failed {
                    input: job.input.clone(),
                    error: failure.line(),
                }));
            }
        }
    }
    bar.finish_and_clear();
    match summaries.as_slice() {
        _ if !arguments.json => {}
        [] => {}
        [only] if jobs.len() == 1 => print(true, only, String::new)?,
        several => print(true, &several, String::new)?,
    }
    match failed {
        0 => Ok(()),
        failed => Err(Failure::SomeFailed {
            failed,
            all: jobs.len(),
        }),
    }
}

/// The first Ctrl-C ends the build in order, which takes less than a second; the next at once. Without a handler it
/// ends at once, too.
pub fn listen() {
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
    });
}

/// A progress bar over some meshes.
pub fn bar(meshes: usize, quiet: bool) -> ProgressBar {
    let bar = match quiet {
        true => ProgressBar::hidden(),
        false => ProgressBar::new(BAR_STEPS * meshes as u64),
    };
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} % {msg} {elapsed}") {
        bar.set_style(style);
    }
    bar
}

/// Builds and writes one mesh; `show` is told the stage and the part done.
fn build_one(
    job: &Job,
    arguments: &BuildArguments,
    show: impl Fn(&str, f32),
) -> Result<BuildSummary, Failure> {
    show("reading", 0.0);
    let mut source = mesh_file::read(&job.input)?;
    let max_error = match arguments.tolerance_in_unit_of(&job.input)? {
        Some(tolerance) => Some((tolerance / f64::from(longest_side(&source))) as f32),
        None => arguments.max_error,
    };
    arguments.placing.place(&mut source);
    let mut options = BuildOptions {
        enclose: !arguments.no_enclose,
        max_error,
        quality: arguments.quality.into(),
        creases: creases(arguments.round_edges),
        ..Default::default()
    };
    if arguments.primitives.is_some() || max_error.is_some() {
        options.primitives = arguments.primitives.map(|n| n as usize);
    }
    let (mesh, report) = MedialMesh::from_trimesh_with_progress(
        &source.vertices,
        &source.indices,
        &options,
        &mut |progress| {
            show(progress.stage, progress.fraction);
            match STOP.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        },
    )?;
    if jobs::is_baked(&job.output) {
        mesh.save_asset(&job.output)?;
    } else {
        mesh.save_ma(&job.output)?;
    }
    let side = report.longest_side;
    Ok(BuildSummary {
        output: job.output.clone(),
        vertices: source.vertices.len(),
        triangles: source.indices.len(),
        mesh: describe(&mesh),
        errors: relative(&report.hausdorff, side),
        errors_before_enclosure: report
            .hausdorff_before_enclosure
            .map(|h| relative(&h, side)),
        longest_side: side,
        target_reached: report.target_reached,
        notes: report.notes,
        seconds: report.seconds,
    })
}

impl BuildSummary {
    fn text(&self) -> String {
        let mut text = format!(
            "{} from {} vertices, {} triangles\n{}{}",
            self.output.display(),
            self.vertices,
            self.triangles,
            self.mesh.text(),
            self.errors.text("errors"),
        );
        if let Some(before) = &self.errors_before_enclosure {
            text += &before.text("errors before the enclosure");
        }
        for note in &self.notes {
            text += &format!("note: {note}\n");
        }
        let total: f64 = self.seconds.iter().map(|(_, s)| s).sum();
        // Writing to a string does not fail.
        let _ = write!(text, "seconds     {total:.2}");
        for (stage, seconds) in &self.seconds {
            let _ = write!(text, ", {stage} {seconds:.2}");
        }
        text + "\n"
    }
}
