//! The progress bar of the examples.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `length` ticks; it shows nothing where the output is no terminal.
pub fn bar(name: &'static str, length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:16} {wide_bar} {pos}/{len} {elapsed}");
    ProgressBar::new(length as u64)
        .with_style(style.expect("a valid template"))
        .with_message(name)
}
