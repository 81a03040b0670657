//! Each folder of `src` lists its files: the doc comment of its map names every file and sub-folder beside it. The map
//! of a folder is its `mod.rs`, for `src` itself `lib.rs`, and for a folder without `mod.rs` the file of its name next
//! to it.

use std::fs;
use std::path::{Path, PathBuf};

/// The folder without a map: it holds one file for each program, and `Cargo.toml` lists those.
const PROGRAMS: &str = "bin";

/// A folder and all folders below it.
fn folders(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![folder.to_owned()];
    for entry in fs::read_dir(folder).expect("a source folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(folders(&path));
        }
    }
    found
}

/// The file whose doc comment lists what is in a folder of `src`.
fn map_of(folder: &Path, src: &Path) -> PathBuf {
    let maps = [folder.join("mod.rs"), folder.with_extension("rs")];
    if folder == src {
        return src.join("lib.rs");
    }
    let map = maps.into_iter().find(|map| map.is_file());
    map.unwrap_or_else(|| panic!("{} has no map", folder.display()))
}

#[test]
fn every_file_is_in_the_map_of_its_folder() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut checked = 0;
    let mut missing = Vec::new();
    for folder in folders(&src) {
        if folder == src.join(PROGRAMS) {
            continue;
        }
        let map = map_of(&folder, &src);
        let text = fs::read_to_string(&map).expect("a readable source");
        let docs: String = text.lines().filter(|l| l.starts_with("//!")).collect();
        for entry in fs::read_dir(&folder).expect("a source folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().and_then(|n| n.to_str());
            let name = name.expect("a name in UTF-8");
            if path == map {
                continue;
            }
            checked += 1;
            // A folder is named as `name/`, or by a link to its module.
            let is_named = if path.is_dir() {
                docs.contains(&format!("`{name}/`")) || docs.contains(&format!("[`{name}`]"))
            } else {
                docs.contains(&format!("`{name}`"))
            };
            if !is_named {
                missing.push(format!("{}: {name}", map.display()));
            }
        }
    }
    missing.sort();
    assert!(
        missing.is_empty(),
        "not in the map of their folder:\n{}",
        missing.join("\n")
    );
    assert!(checked > 300, "the check found only {checked} files");
}
