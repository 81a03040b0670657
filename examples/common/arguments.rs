//! Command line options and exit code of an example, without a parser crate.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

/// What stands behind the program's name and was not taken yet.
pub struct Arguments(Vec<String>);

impl Arguments {
    /// The arguments that the program was started with.
    pub fn from_env() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    /// Takes `--name`; false where it is not given.
    pub fn flag(&mut self, name: &str) -> bool {
        let place = self.0.iter().position(|a| a == name);
        place.map(|k| self.0.remove(k)).is_some()
    }

    /// Takes `--name VALUE`; `None` where it is not given.
    pub fn value<T: FromStr>(&mut self, name: &str) -> Result<Option<T>, String> {
        let Some(place) = self.0.iter().position(|a| a == name) else {
            return Ok(None);
        };
        self.0.remove(place);
        if place == self.0.len() {
            return Err(format!("{name} needs a value"));
        }
        let value = self.0.remove(place);
        let parsed = value.parse().map(Some);
        parsed.map_err(|_| format!("{name} cannot be `{value}`"))
    }

    /// Takes the first argument that is left; to be called after all options.
    pub fn file(&mut self) -> Option<PathBuf> {
        (!self.0.is_empty()).then(|| self.0.remove(0).into())
    }

    /// Refuses what no option took.
    pub fn finish(self) -> Result<(), String> {
        match self.0.first() {
            None => Ok(()),
            Some(unknown) => Err(format!("unknown argument `{unknown}`")),
        }
    }
}

/// Runs an example: exits with 2 on arguments that it cannot take, with 1 on a check that failed.
pub fn example<Options>(
    options: impl FnOnce(&mut Arguments) -> Result<Options, String>,
    work: impl FnOnce(Options) -> Result<(), String>,
) -> ExitCode {
    let mut arguments = Arguments::from_env();
    let options = options(&mut arguments).and_then(|options| arguments.finish().map(|()| options));
    match options.map(work) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failed)) => {
            eprintln!("FAILED: {failed}");
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Runs an example whose one option is `--out DIR`: where its pictures go, else `folder`.
pub fn example_with_out(folder: &str, work: impl FnOnce(&Path) -> Result<(), String>) -> ExitCode {
    let out = |arguments: &mut Arguments| arguments.value("--out");
    example(out, |out: Option<PathBuf>| {
        work(&out.unwrap_or(folder.into()))
    })
}

/// What an example of a mesh of the user's is told: `[FILE] [--primitives N] [--out DIR]`.
pub struct MeshOptions {
    /// The mesh's file; without one the example makes a mesh.
    pub file: Option<PathBuf>,
    /// The most primitives that the medial mesh may have.
    pub primitives: usize,
    /// Where the pictures go.
    pub out: PathBuf,
}

/// Runs an example of a mesh of the user's, with `primitives` and `folder` where nothing else is told.
pub fn example_with_mesh(
    primitives: usize,
    folder: &str,
    work: impl FnOnce(MeshOptions) -> Result<(), String>,
) -> ExitCode {
    let options = |arguments: &mut Arguments| {
        Ok(MeshOptions {
            primitives: arguments
                .value("--primitives")?
                .map_or(primitives, NonZeroUsize::get),
            out: arguments.value("--out")?.unwrap_or(folder.into()),
            file: arguments.file(),
        })
    };
    example(options, work)
}

/// Fails with all that failed.
pub fn verdict(failures: Vec<String>) -> Result<(), String> {
    if failures.is_empty() {
        return Ok(());
    }
    Err(failures.join("; "))
}
