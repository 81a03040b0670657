//! The links between pages lead somewhere: each names a page that is there, and a heading of it if it names one. The
//! paths of source files that the maps of the code name are there. Shaders and their Rust twins name each other.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

/// All pages in a folder and below it.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of pages") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(pages(&path));
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
    found
}

/// The names by which links reach the headings of a page: small letters, hyphens for spaces, no other signs.
fn anchors(text: &str) -> HashSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let name = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = name.chars().filter_map(|c| match c {
            ' ' => Some('-'),
            c if c.is_alphanumeric() || "-_".contains(c) => Some(c),
            _ => None,
        });
        kept.collect()
    };
    headings.map(anchor).collect()
}

/// What stands in the round brackets of links.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let after = text.split("](").skip(1);
    after.filter_map(|rest| rest.split(')').next())
}

#[test]
fn links_between_pages_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = pages(&root.join("docs"));
    all.extend(["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root.join(name)));
    let mut checked = 0;
    let mut wrong = Vec::new();
    for page in &all {
        let text = fs::read_to_string(page).expect("a page");
        for link in links(&text) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            if file.contains("://") || !(file.is_empty() || file.ends_with(".md")) {
                continue;
            }
            let target = match file {
                "" => page.clone(),
                file => page.parent().unwrap_or(root).join(file),
            };
            let found = fs::read_to_string(&target)
                .is_ok_and(|text| heading.is_empty() || anchors(&text).contains(heading));
            checked += 1;
            if !found {
                wrong.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(checked > 50, "only {checked} links were found");
}

/// The maps for those who change the code.
#[test]
fn files_named_by_the_maps_of_the_code_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut checked = 0;
    let mut wrong = Vec::new();
    for map in ["CONTRIBUTING.md", "docs/host.md"] {
        let text = fs::read_to_string(root.join(map)).expect("a map");
        for named in text.split('`').skip(1).step_by(2) {
            let file = named.split(' ').next().unwrap_or(named);
            let is_path = ["src/", "tests/", "shaders/", "benches/"]
                .iter()
                .any(|folder| file.starts_with(folder));
            if !is_path || file.contains('*') {
                continue;
            }
            checked += 1;
            if !root.join(file).exists() {
                wrong.push(format!("{map}: {named}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(checked > 60, "only {checked} paths were found");
}

#[test]
fn shaders_and_their_twins_in_rust_name_each_other() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut checked = 0;
    for entry in fs::read_dir(root.join("shaders")).expect("a folder of shaders") {
        let path = entry.expect("an entry").path();
        let shader = path.file_name().expect("a name").to_string_lossy();
        let text = fs::read_to_string(&path).expect("a shader");
        let head = text.lines().take_while(|line| line.starts_with("//"));
        let words = head.flat_map(|line| line.split([' ', ',', ';', '(', ')', '`']));
        let twins = words.filter(|word| word.starts_with("src/"));
        let before = checked;
        for twin in twins.map(|word| word.trim_end_matches(['.', ':'])) {
            let twin_text = fs::read_to_string(root.join(twin)).unwrap_or_default();
            assert!(
                twin_text.contains(&*shader),
                "{twin} does not name {shader}"
            );
            checked += 1;
        }
        assert!(checked > before, "{shader} names no twin");
    }
}
