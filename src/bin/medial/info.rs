//! `medial info` and `medial bake`: what a medial mesh is, and the same in a file that loads at once.

use crate::build::QualityArgument;
use crate::curve::curve;
use crate::describe::{Description, Errors, describe, relative};
use crate::failure::Failure;
use crate::jobs::{self, PlanError};
use crate::lengths::longest_side;
use crate::output::print;
use crate::placing::PlacingArguments;
use crate::refuse;
use clap::Args;
use rapier3d_medial::medial::asset;
use rapier3d_medial::meshing::hausdorff;
use rapier3d_medial::meshing::mesh_file::{self, MeshFormat, TriangleMesh};
use rapier3d_medial::{BuildError, MedialMesh};
use serde::Serialize;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct BakeArguments {
    /// Medial mesh (.ma or .medial).
    input: PathBuf,
    /// Where to write the baked mesh.
    #[arg(short, long, value_name = "OUT.medial")]
    output: PathBuf,
}

/// Counts of primitives that a curve has unless told.
const COUNTS: [u32; 6] = [10, 20, 50, 100, 200, 500];

#[derive(Args)]
pub struct InfoArguments {
    /// Medial mesh (.ma or .medial); with --curve a triangle mesh.
    pub mesh: PathBuf,
    /// Measure how far the medial mesh is from the triangle mesh that it was built from.
    #[arg(long, value_name = "IN")]
    against: Option<PathBuf>,
    #[command(flatten)]
    pub placing: PlacingArguments,
    /// Show the error of a triangle mesh at several numbers of primitives.
    #[arg(long, conflicts_with = "against")]
    curve: bool,
    /// Numbers of primitives for --curve.
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', requires = "curve", default_values_t = COUNTS,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub counts: Vec<u32>,
    /// With --curve: how much work to spend on making the error small.
    #[arg(short, long, value_enum, default_value_t, requires = "curve")]
    pub quality: QualityArgument,
    /// With --curve: fit the surface from both sides instead of covering it.
    #[arg(long, requires = "curve")]
    pub no_enclose: bool,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Summary that `info` prints.
#[derive(Serialize)]
struct InfoSummary {
    #[serde(flatten)]
    mesh: Description,
    volume: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<Errors>,
}

/// Reads a baked mesh or a `.ma` file, by its first bytes. What cannot be opened is left to the reader to
/// report.
pub fn load(path: &Path) -> Result<MedialMesh, Failure> {
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

/// Writes a medial mesh baked.
pub fn bake(arguments: &BakeArguments) -> Result<(), Failure> {
    jobs::check_output(&arguments.input, &arguments.output)?;
    if !jobs::is_baked(&arguments.output) {
        return Err(PlanError::BakedOutput(arguments.output.clone()).into());
    }
    Ok(load(&arguments.input)?.save_asset(&arguments.output)?)
}

/// Describes a mesh, and measures it against its source where one is given.
pub fn info(arguments: &InfoArguments) -> Result<(), Failure> {
    if arguments.curve {
        return curve(arguments);
    }
    if arguments.placing.is_given() && arguments.against.is_none() {
        refuse("--scale and --up are for a triangle mesh: that of --against IN, or with --curve");
    }
    let mesh = load(&arguments.mesh)?;
    let errors = match &arguments.against {
        Some(path) => {
            let measured = mesh_file::read(path).and_then(|mut source| {
                arguments.placing.place(&mut source);
                measure(&mesh, &source)
            });
            Some(measured.map_err(|e| Failure::from(e).of(path))?)
        }
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
    Ok(relative(&measured, longest_side(source)))
}
