//! Output of the program.

use crate::failure::Failure;
use serde::{Serialize, Serializer};
use std::io::{self, ErrorKind, Write as _};
use std::path::Path;

/// A failure, on standard error.
pub fn say(failure: &Failure) {
    eprintln!("medial: {}", failure.line());
}

/// Prints as JSON or as text.
pub fn print(json: bool, value: &impl Serialize, text: impl Fn() -> String) -> Result<(), Failure> {
    let printed = if json {
        serde_json::to_string_pretty(value).map_err(io::Error::from)? + "\n"
    } else {
        text()
    };
    write(&printed)
}

/// A path in JSON, which has no signs for bytes that are not UTF-8: they are replaced.
pub fn path<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

/// Writes to standard output. A reader that went away, as `head` does, is no failure.
pub fn write(text: &str) -> Result<(), Failure> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
