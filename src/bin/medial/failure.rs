//! Why the program ends with exit code 1, in one line that names the file.

#[cfg(feature = "gpu")]
use crate::calibrate;
use crate::jobs::PlanError;
use crate::lengths::UnitUnknown;
use rapier3d_medial::{BuildError, MeshError};
use serde::Serialize;
use std::io;
use std::path::{Path, PathBuf};

/// Failure of the program.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Calibrate(#[from] calibrate::Failure),
    #[error(transparent)]
    Unit(#[from] UnitUnknown),
    #[error(
        "{0} is a triangle mesh, not a medial mesh: build one with `medial build {0} -o OUT.medial`, or show its error \
         at several numbers of primitives with `medial info --curve {0}`"
    )]
    TriangleMesh(PathBuf),
    #[error("{path}: {source}")]
    OfFile { path: PathBuf, source: Box<Failure> },
    #[error("{0} is not a triangle mesh, which --curve needs")]
    NoTriangleMesh(PathBuf),
    #[error("rapier cannot make a convex hull of this mesh")]
    NoHull,
    #[error("{0}")]
    NoPicture(String),
    #[error("cancelled during {0}")]
    Stopped(&'static str),
    #[error("{failed} of {all} meshes failed")]
    SomeFailed { failed: usize, all: usize },
    #[error("standard output: {0}")]
    Output(#[from] io::Error),
}

impl Failure {
    /// The failure, with the file it is about added; most errors of files name it already.
    pub fn of(self, path: &Path) -> Self {
        if self.to_string().contains(&path.display().to_string()) {
            return self;
        }
        Self::OfFile {
            path: path.to_owned(),
            source: Box::new(self),
        }
    }

    /// One line, whatever the message holds.
    pub fn line(&self) -> String {
        let message = self.to_string();
        message.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// A mesh of several that was not built, in JSON beside those that were.
#[derive(Serialize)]
pub struct Failed {
    /// The triangle mesh.
    #[serde(serialize_with = "crate::output::path")]
    pub input: PathBuf,
    /// The error, in words.
    pub error: String,
}
