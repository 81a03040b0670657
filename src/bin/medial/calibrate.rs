//! `medial calibrate`: from which batch sizes on the GPU pays.

use clap::Args;
use rapier3d_medial::batch::Calibration;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions};
use rapier3d_medial::{GpuError, MedialMesh};
use std::path::PathBuf;

#[derive(Args)]
pub struct CalibrateArguments {
    /// Medial mesh that is typical of the scene: .ma or baked.
    pub mesh: PathBuf,
    /// Where to write the sizes: text for `Calibration` to read.
    #[arg(short, long, value_name = "OUT.txt")]
    output: PathBuf,
    /// Accept an adapter that is simulated on the CPU, too.
    #[arg(long)]
    software: bool,
}

/// Measures and writes; returns what was written.
pub fn calibrate(arguments: &CalibrateArguments, mesh: &MedialMesh) -> Result<String, Failure> {
    let options = GpuOptions {
        software: arguments.software,
        ..GpuOptions::default()
    };
    let mut gpu = pollster::block_on(Gpu::open(options))?;
    let text = Calibration::measure(&mut gpu, mesh)?.to_string();
    std::fs::write(&arguments.output, &text).map_err(|source| Failure::Write {
        path: arguments.output.clone(),
        source,
    })?;
    Ok(text)
}

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error("cannot write {}: {source}", path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
}
