//! Work list of `medial build`: which triangle meshes, and where each result goes. Everything that can be refused is
//! refused before minutes of work.

use rapier3d_medial::meshing::mesh_file::MeshFormat;
use std::collections::HashMap;
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};

/// One mesh to build.
#[derive(Debug)]
pub struct Job {
    /// The triangle mesh.
    pub input: PathBuf,
    /// File that the medial mesh goes to.
    pub output: PathBuf,
}

/// Why nothing is built.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    #[error("{0} is the input: the output would replace it")]
    OverInput(PathBuf),
    #[error("{0}: the output is a medial mesh; name a file that ends in .ma or .medial")]
    MeshOutput(PathBuf),
    #[error("{0}: the output is a baked mesh; name a file that ends in .medial")]
    BakedOutput(PathBuf),
    #[error("{0}: the output is a picture; name a file that ends in .png")]
    PictureOutput(PathBuf),
    #[error(
        "{0} has the name of a file: several meshes, or a folder of them, go into a folder; name a folder"
    )]
    FileForSeveral(PathBuf),
    #[error("{0}: no such directory")]
    NoDirectory(PathBuf),
    #[error("{0}: no triangle mesh in it (obj, stl, ply, off, glb, gltf)")]
    NoMeshes(PathBuf),
    #[error("{output}: both {first} and {second} would go there")]
    SameOutput {
        output: PathBuf,
        first: PathBuf,
        second: PathBuf,
    },
    #[error("{path}: {source}")]
    Path { path: PathBuf, source: io::Error },
}

/// One job per mesh; a folder stands for all meshes in it. Several meshes go into the folder
/// `output`, which is made if it is not there and does not have the name of a mesh; a single one goes to the file, or
/// into the folder.
///
/// Files that go into a folder are baked if `bake` says so; a single file has to have the ending for it.
pub fn plan(inputs: &[PathBuf], output: &Path, bake: bool) -> Result<Vec<Job>, PlanError> {
    let mut meshes = Vec::new();
    for input in inputs {
        if input.is_dir() {
            meshes.extend(meshes_in(input)?);
        } else {
            meshes.push(input.clone());
        }
    }
    let single = matches!(inputs, [only] if !only.is_dir());
    let into_folder = !single || output.is_dir();
    if bake && !into_folder && !is_baked(output) {
        return Err(PlanError::BakedOutput(output.to_owned()));
    }
    let is_new = into_folder && !output.is_dir();
    if is_new {
        let is_mesh = ends_in(output, &["ma", "medial"]) || MeshFormat::of(output).is_some();
        if is_mesh || output.is_file() {
            return Err(PlanError::FileForSeveral(output.to_owned()));
        }
        check_parent(output)?;
    }
    let mut taken: HashMap<PathBuf, PathBuf> = HashMap::new();
    let mut jobs = Vec::new();
    for input in meshes {
        let output = if into_folder {
            // A stem may have dots of its own, which `with_extension` would take for an ending.
            let mut name = input.file_stem().unwrap_or_default().to_owned();
            name.push(if bake { ".medial" } else { ".ma" });
            output.join(name)
        } else {
            output.to_owned()
        };
        if let Some(first) = taken.insert(output.clone(), input.clone()) {
            return Err(PlanError::SameOutput {
                output,
                first,
                second: input,
            });
        }
        jobs.push(Job { input, output });
    }
    if is_new {
        std::fs::create_dir(output).map_err(|source| PlanError::Path {
            path: output.to_owned(),
            source,
        })?;
    }
    for job in &jobs {
        check_output(&job.input, &job.output)?;
    }
    Ok(jobs)
}

/// The triangle meshes in a folder, by name.
fn meshes_in(folder: &Path) -> Result<Vec<PathBuf>, PlanError> {
    let failed = |source| PlanError::Path {
        path: folder.to_owned(),
        source,
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_file() && MeshFormat::of(&path).is_some() {
            found.push(path);
        }
    }
    if found.is_empty() {
        return Err(PlanError::NoMeshes(folder.to_owned()));
    }
    found.sort();
    Ok(found)
}

/// Refuses, before minutes of work, an output that cannot be or must not be written.
pub fn check_output(input: &Path, output: &Path) -> Result<(), PlanError> {
    check_parent(output)?;
    if is_same_file(output, input) {
        return Err(PlanError::OverInput(output.to_owned()));
    }
    match ends_in(output, &["ma", "medial"]) {
        true => check_writable(output),
        false => Err(PlanError::MeshOutput(output.to_owned())),
    }
}

/// Refuses a file that cannot be written. One that is there stays as it is, and links and pipes are not looked into.
fn check_writable(output: &Path) -> Result<(), PlanError> {
    let there = std::fs::symlink_metadata(output);
    if there
        .as_ref()
        .is_ok_and(|there| !there.is_file() && !there.is_dir())
    {
        return Ok(());
    }
    let is_new = there.is_err();
    let opened = OpenOptions::new().append(true).create(true).open(output);
    let closed = opened.and_then(|_| match is_new {
        true => std::fs::remove_file(output),
        false => Ok(()),
    });
    closed.map_err(|source| PlanError::Path {
        path: output.to_owned(),
        source,
    })
}

/// Whether a medial mesh goes to a file baked, by its ending.
pub fn is_baked(output: &Path) -> bool {
    ends_in(output, &["medial"])
}

/// Refuses, before any work, a picture that cannot be or must not be written.
pub fn check_picture(input: Option<&Path>, output: &Path) -> Result<(), PlanError> {
    check_parent(output)?;
    if input.is_some_and(|input| is_same_file(output, input)) {
        return Err(PlanError::OverInput(output.to_owned()));
    }
    match ends_in(output, &["png"]) && !output.is_dir() {
        true => check_writable(output),
        false => Err(PlanError::PictureOutput(output.to_owned())),
    }
}

fn ends_in(path: &Path, endings: &[&str]) -> bool {
    let own = path.extension().and_then(|e| e.to_str());
    own.is_some_and(|own| endings.iter().any(|e| own.eq_ignore_ascii_case(e)))
}

fn check_parent(output: &Path) -> Result<(), PlanError> {
    let directory = match output.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    match directory.is_dir() {
        true => Ok(()),
        false => Err(PlanError::NoDirectory(directory.to_owned())),
    }
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
