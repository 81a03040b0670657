//! The command line program `medial`: builds medial meshes from triangle meshes, bakes and describes
//! them.
//!
//! Results go to standard output, progress and errors to standard error. Exit code 1 with one line
//! on failure, 2 for arguments that make no sense.

#[cfg(feature = "gpu")]
#[path = "medial/calibrate.rs"]
mod calibrate;
#[path = "medial/describe.rs"]
mod describe;
#[path = "medial/failure.rs"]
mod failure;
#[path = "medial/jobs.rs"]
mod jobs;

use clap::{Args, Parser, Subcommand, ValueEnum};
use describe::{Description, Errors, describe, relative};
use failure::{Failed, Failure};
use indicatif::{ProgressBar, ProgressStyle};
use jobs::{Job, plan};
use rapier3d_medial::build::hausdorff;
use rapier3d_medial::build::mesh_file::{self, MeshFormat, TriangleMesh};
use rapier3d_medial::math::Vector;
use rapier3d_medial::medial::asset;
use rapier3d_medial::{BuildError, BuildOptions, MedialMesh, Quality};
use serde::Serialize;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Steps of the progress bar (a count) for each mesh: one per mille.
const BAR_STEPS: u64 = 1000;

/// Exit code after Ctrl-C, as shells have it: 128 and the signal's number.
const INTERRUPTED: u8 = 130;

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Medial meshes: concave colliders for rapier that never tunnel.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build medial meshes (.ma, or baked as .medial) from triangle meshes (obj, stl, ply, off).
    Build(BuildArguments),
    /// Bake a medial mesh (.ma) with its trees and mass properties, to load in no time.
    Bake(BakeArguments),
    /// Describe a medial mesh (.ma or baked).
    Info(InfoArguments),
    /// Measure from which batch sizes on the GPU pays, for `Backend::Auto`.
    #[cfg(feature = "gpu")]
    Calibrate(calibrate::CalibrateArguments),
}

#[derive(Args)]
struct BuildArguments {
    /// Triangle meshes: obj, stl, ply or off, or folders of them.
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    /// Where to write the medial mesh: baked, with the mass properties of the triangle mesh, if it ends
    /// in .medial, else in the .ma format, which has none; of several, the folder to write them into.
    #[arg(short, long, value_name = "OUT.ma")]
    output: PathBuf,
    /// Largest number of primitives: slabs, cones that belong to no slab, lone spheres
    /// [default: 500, or what --max-error needs].
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    primitives: Option<u32>,
    /// Largest two-sided Hausdorff error, as a fraction of the longest side of the mesh's box.
    #[arg(short = 'e', long, value_name = "E", value_parser = positive)]
    max_error: Option<f32>,
    /// How much work to spend on a small error.
    #[arg(short, long, value_enum, default_value_t)]
    quality: QualityArgument,
    /// Fit the surface on both sides instead of enclosing it.
    #[arg(long)]
    no_enclose: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
}

/// [`Quality`], as an argument.
#[derive(Clone, Copy, Default, ValueEnum)]
enum QualityArgument {
    /// Edge collapse alone.
    Fast,
    /// Then a fit to the surface.
    #[default]
    Balanced,
    /// Then several starts and swaps.
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

#[derive(Args)]
struct BakeArguments {
    /// Medial mesh in the .ma format, or baked.
    input: PathBuf,
    /// Where to write the baked mesh.
    #[arg(short, long, value_name = "OUT.medial")]
    output: PathBuf,
}

#[derive(Args)]
struct InfoArguments {
    /// Medial mesh in the .ma format, or baked.
    mesh: PathBuf,
    /// Measure both Hausdorff distances to the triangle mesh that it was built from.
    #[arg(long, value_name = "IN")]
    against: Option<PathBuf>,
    /// Print as JSON.
    #[arg(long)]
    json: bool,
}

/// What `info` found.
#[derive(Serialize)]
struct InfoSummary {
    #[serde(flatten)]
    mesh: Description,
    volume: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<Errors>,
}

/// What a build did.
#[derive(Serialize)]
struct BuildSummary {
    output: PathBuf,
    vertices: usize,
    triangles: usize,
    mesh: Description,
    errors: Errors,
    errors_before_enclosure: Option<Errors>,
    longest_side: f32,
    euler: i64,
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

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Build(arguments) => build(&arguments),
        Command::Bake(arguments) => bake(&arguments),
        Command::Info(arguments) => info(&arguments),
        #[cfg(feature = "gpu")]
        Command::Calibrate(arguments) => load(&arguments.mesh)
            .and_then(|mesh| Ok(calibrate::calibrate(&arguments, &mesh)?))
            .and_then(|text| Ok(write!(io::stdout(), "{text}")?)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&failure);
            match STOP.load(Ordering::Relaxed) {
                true => INTERRUPTED.into(),
                false => ExitCode::FAILURE,
            }
        }
    }
}

fn say(failure: &Failure) {
    eprintln!("medial: {}", failure.line());
}

fn positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a positive number".into()),
    }
}

fn build(arguments: &BuildArguments) -> Result<(), Failure> {
    let jobs = plan(&arguments.inputs, &arguments.output)?;
    // The first Ctrl-C ends the build in order, which takes less than a second; the next at once.
    // Without a handler it ends at once, too.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
    });
    let bar = ProgressBar::new(BAR_STEPS * jobs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} % {msg} {elapsed}") {
        bar.set_style(style);
    }
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

/// Builds and writes one mesh; `show` is told the stage and the part done.
fn build_one(
    job: &Job,
    arguments: &BuildArguments,
    show: impl Fn(&str, f32),
) -> Result<BuildSummary, Failure> {
    show("reading", 0.0);
    let source = mesh_file::read(&job.input)?;
    let mut options = BuildOptions {
        enclose: !arguments.no_enclose,
        max_error: arguments.max_error,
        quality: arguments.quality.into(),
        ..Default::default()
    };
    if arguments.primitives.is_some() || arguments.max_error.is_some() {
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
    if job.output.extension().is_some_and(|e| e == "medial") {
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
        euler: report.euler,
        target_reached: report.target_reached,
        notes: report.notes,
        seconds: report.seconds,
    })
}

/// Reads a baked mesh or a `.ma` file, by its first bytes. What cannot be opened is left to the reader to
/// report.
fn load(path: &Path) -> Result<MedialMesh, Failure> {
    let mut start = [0; asset::MAGIC.len()];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    if read.is_ok() && start == asset::MAGIC {
        return Ok(MedialMesh::load_asset(path)?);
    }
    if path.is_file() && MeshFormat::of(path).is_some() {
        return Err(Failure::TriangleMesh(path.to_owned()));
    }
    Ok(MedialMesh::load_ma(path)?)
}

fn bake(arguments: &BakeArguments) -> Result<(), Failure> {
    jobs::check_output(&arguments.input, &arguments.output)?;
    Ok(load(&arguments.input)?.save_asset(&arguments.output)?)
}

fn info(arguments: &InfoArguments) -> Result<(), Failure> {
    let mesh = load(&arguments.mesh)?;
    let errors = match &arguments.against {
        Some(path) => Some(measure(&mesh, &mesh_file::read(path)?)?),
        None => None,
    };
    let summary = InfoSummary {
        mesh: describe(&mesh),
        volume: mesh.volume(),
        errors,
    };
    print(arguments.json, &summary, || {
        let errors = summary.errors.as_ref();
        let volume = format!("volume      {}\n", summary.volume);
        summary.mesh.text() + &volume + &errors.map_or(String::new(), |e| e.text("errors"))
    })
}

fn measure(mesh: &MedialMesh, source: &TriangleMesh) -> Result<Errors, BuildError> {
    let measured = hausdorff::hausdorff(mesh, &source.vertices, &source.indices)?;
    let corners = source.indices.iter().flatten();
    let points = corners.map(|&v| source.vertices[v as usize]);
    let (lo, hi) = points.fold((Vector::MAX, Vector::MIN), |(lo, hi), p| {
        (lo.min(p), hi.max(p))
    });
    Ok(relative(&measured, (hi - lo).max_element()))
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

/// Prints as JSON or as text. A reader that went away, as `head` does, is no failure.
fn print(json: bool, value: &impl Serialize, text: impl Fn() -> String) -> Result<(), Failure> {
    let printed = if json {
        serde_json::to_string_pretty(value).map_err(io::Error::from)? + "\n"
    } else {
        text()
    };
    match io::stdout().write_all(printed.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
