//! Writing files safely: if a write fails half way, the old file is still there. Devices and pipes are written to.

use crate::error::MeshError;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes a new file beside `path`, then renames it to `path`. If `path` is a link, the file that it leads to is
/// replaced. If it is a device or pipe (`/dev/stdout`), which no file may take the place of, it is written to.
pub fn replace(path: &Path, write: impl FnOnce(&File) -> io::Result<()>) -> Result<(), MeshError> {
    let followed = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&followed).is_ok_and(|is| !is.is_file() && !is.is_dir()) {
        let opened = OpenOptions::new().write(true).open(&followed);
        return opened
            .and_then(|file| write(&file))
            .map_err(|source| file_error(path, source));
    }
    let (partial, file) = create_beside(&followed).map_err(|source| file_error(path, source))?;
    write(&file)
        .and_then(|()| file.sync_all())
        .and_then(|()| fs::rename(&partial, &followed))
        .map_err(|source| {
            // The first error is the one to report; a leftover partial file is harmless.
            let _ = fs::remove_file(&partial);
            file_error(path, source)
        })
}

/// An error of the file system, with the file.
pub fn file_error(path: &Path, source: io::Error) -> MeshError {
    MeshError::File {
        path: path.to_owned(),
        source,
    }
}

/// A new file in the directory of `path`, under a name that no other writer has.
fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
    let mut partial = name.to_os_string();
    let unique = NEXT.fetch_add(1, Ordering::Relaxed);
    partial.push(format!(".{}-{unique}.partial", std::process::id()));
    let partial = path.with_file_name(partial);
    let file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&partial)?;
    Ok((partial, file))
}
