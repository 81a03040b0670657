//! The checklist for an upgrade of rapier (docs/host.md) is whole: the files that it names are there, it names every
//! file of `src/rapier/host/`, and its names that begin with `host::` are the tests of `tests/host/`.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// What stands between backquotes in the page.
fn named() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/host.md")).expect("a page");
    text.split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

#[test]
fn files_named_as_workarounds_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let named = named();
    let files: BTreeSet<&str> = named
        .iter()
        .filter(|n| n.ends_with(".rs") && n.contains('/'))
        .map(String::as_str)
        .collect();
    let missing: Vec<&&str> = files.iter().filter(|f| !root.join(f).exists()).collect();
    assert!(missing.is_empty(), "{missing:?}");
    for entry in fs::read_dir(root.join("rapier/host")).expect("a folder") {
        let name = entry.expect("an entry").file_name();
        let name = format!("rapier/host/{}", name.to_string_lossy());
        assert!(
            name.ends_with("mod.rs") || files.contains(name.as_str()),
            "docs/host.md does not name {name}"
        );
    }
}

/// Names of the functions of a test file that follow `#[test]`.
fn tests_in(text: &str) -> impl Iterator<Item = &str> {
    let after = text.split("#[test]\n").skip(1);
    after.filter_map(|rest| rest.trim_start().strip_prefix("fn ")?.split('(').next())
}

#[test]
fn tests_of_rapier_and_parry_alone_are_those_of_the_page() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/host");
    let mut tests = BTreeSet::new();
    for file in ["main", "rapier", "parry"] {
        let text = fs::read_to_string(folder.join(format!("{file}.rs"))).expect("a test file");
        let room = if file == "main" {
            String::new()
        } else {
            format!("{file}::")
        };
        tests.extend(tests_in(&text).map(|name| format!("host::{room}{name}")));
    }
    let named = named().into_iter().filter(|n| n.starts_with("host::"));
    assert_eq!(named.collect::<BTreeSet<_>>(), tests);
}
