//! The command line program `medial`: builds medial meshes from triangle meshes, bakes and describes
//! them, and compares them with the other colliders that rapier has.
//!
//! Results go to standard output, progress and errors to standard error. Exit code 1 with one line
//! on failure, 2 for arguments that make no sense.
//!
//! # Files
//! - Commands: `build.rs` (with its work list `jobs.rs`), `info.rs` (`info` and `bake`; for `info --curve` `curve.rs`),
//!   `compare.rs` (with its picture `compare_picture.rs`), `calibrate.rs`.
//! - What is read: `placing.rs` (`--scale` and `--up`), `lengths.rs` (lengths with units).
//! - What is printed: `output.rs` (standard output), `describe.rs` (meshes and errors in words), `failure.rs` (the one
//!   line of exit code 1).

#[path = "medial/build.rs"]
mod build;
#[cfg(feature = "gpu")]
#[path = "medial/calibrate.rs"]
mod calibrate;
#[path = "../../examples/common/mod.rs"]
mod common;
#[path = "medial/compare.rs"]
mod compare;
#[path = "medial/compare_picture.rs"]
mod compare_picture;
#[path = "medial/curve.rs"]
mod curve;
#[path = "medial/describe.rs"]
mod describe;
#[path = "medial/failure.rs"]
mod failure;
#[path = "medial/info.rs"]
mod info;
#[path = "medial/jobs.rs"]
mod jobs;
#[path = "medial/lengths.rs"]
mod lengths;
#[path = "medial/output.rs"]
mod output;
#[path = "medial/placing.rs"]
mod placing;

use build::BuildArguments;
use clap::error::ErrorKind;
use clap::{CommandFactory as _, Parser, Subcommand};
use compare::CompareArguments;
use info::{BakeArguments, InfoArguments};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code after Ctrl-C, as shells have it: 128 and the signal's number.
const INTERRUPTED: u8 = 130;

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Medial meshes: concave colliders for rapier with continuous collision detection.
#[derive(Parser)]
#[command(
    name = "medial",
    version,
    after_help = "Exit codes: 0 all went well, 1 something failed, 2 wrong command line, 130 stopped by Ctrl-C."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build medial meshes (.ma, or baked as .medial) from triangle meshes (obj, stl, ply, off, glb, gltf).
    Build(BuildArguments),
    /// Turn a medial mesh (.ma) into one that loads at once (.medial), with its trees and mass properties.
    Bake(BakeArguments),
    /// Describe a medial mesh (.ma or .medial), or show the error of a triangle mesh at several numbers of primitives.
    Info(InfoArguments),
    /// Draw a mesh, its medial mesh, convex decomposition and convex hull side by side, and measure error and cost of
    /// each, scaled to a longest side of one metre.
    Compare(CompareArguments),
    /// Measure how large a batch must be for the GPU to be faster than the CPU, for `Backend::Auto`.
    #[cfg(feature = "gpu")]
    Calibrate(calibrate::CalibrateArguments),
}

/// Ends the program with a message about the command line.
fn refuse(message: &str) -> ! {
    Arguments::command()
        .error(ErrorKind::MissingRequiredArgument, message)
        .exit()
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Build(arguments) => build::build(&arguments),
        Command::Bake(arguments) => info::bake(&arguments),
        Command::Info(arguments) => info::info(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        #[cfg(feature = "gpu")]
        Command::Calibrate(arguments) => info::load(&arguments.mesh)
            .and_then(|mesh| Ok(calibrate::calibrate(&arguments, &mesh)?))
            .and_then(|text| output::write(&text.to_string())),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::say(&failure);
            match STOP.load(Ordering::Relaxed) {
                true => INTERRUPTED.into(),
                false => ExitCode::FAILURE,
            }
        }
    }
}
