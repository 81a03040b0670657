//! The import rules of the design, checked on the source text: imports go down the layers only, and
//! each foreign library stays in its layer. The links between pages lead somewhere, and each folder lists its files.

mod circles;
mod host;
mod links;
mod maps;

use std::fs;
use std::path::{Path, PathBuf};

/// Folder of a layer, and the folders it may import from (`crate::…`).
const LAYERS: [(&str, &[&str]); 8] = [
    ("math", &["math"]),
    ("medial", &["medial", "math", "error"]),
    ("meshing", &["meshing", "medial", "math", "error"]),
    ("elementary", &["elementary", "medial", "math"]),
    ("pair", &["pair", "elementary", "medial", "math"]),
    (
        "batch",
        &["batch", "pair", "elementary", "medial", "math", "error"],
    ),
    (
        "parry",
        &["parry", "batch", "pair", "elementary", "medial", "math"],
    ),
    (
        "rapier",
        &[
            "rapier",
            "parry",
            "batch",
            "pair",
            "elementary",
            "medial",
            "math",
            "error",
        ],
    ),
];

/// Rooms of a layer, in order: folders, and files beside them. Each may import from itself and from those before it.
const ROOMS: [(&str, &[&str]); 3] = [
    (
        "parry",
        &[
            "shape_id",
            "partners",
            "queries",
            "contacts",
            "corrections",
            "rays",
            "medial_part",
            "shape",
            "narrow_phase_plan",
            "dispatcher",
            "by_parry",
            "contact_manifolds",
        ],
    ),
    (
        "meshing",
        &[
            "geometry", "surface", "axis", "certify", "simplify", "refine", "recipe",
        ],
    ),
    (
        "rapier",
        &[
            "effects",
            "tuning",
            "view",
            "host",
            "joints",
            "impacts",
            "contacts",
            "world",
            "report",
            "step_args",
            "step_plan",
            "loans",
            "state",
            "planning",
            "resolving",
            "step",
            "pipeline",
            "pipeline_for_sets",
            "prepare",
            "integration",
        ],
    ),
];

/// Libraries that only one folder may name, as `name::`.
const CONFINED: [(&str, &str); 4] = [
    ("rapier3d", "src/rapier"),
    ("wgpu", "src/batch/gpu"),
    ("robust", "src/meshing"),
    ("QueryDispatcher", "src/parry"),
];

/// The line count above which a file should have been split.
const LONGEST: usize = 400;

/// The line count above which a function should have been split.
const LONGEST_FUNCTION: usize = 80;

/// Columns of a comment's line.
const WIDEST: usize = 120;

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a source folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

fn code_lines(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).expect("a readable source");
    text.lines()
        .map(|l| l.split("//").next().unwrap_or("").to_owned())
        .collect()
}

/// Root names of all `crate::…` paths on a line; `crate::{a, b}` counts each.
fn imports(line: &str) -> Vec<String> {
    let mut names = Vec::new();
    for (at, _) in line.match_indices("crate::") {
        if line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let rest = &line[at + "crate::".len()..];
        let inner = rest.strip_prefix('{').map_or(rest, |r| r);
        let group = rest.starts_with('{');
        for part in inner.split(',').take(if group { usize::MAX } else { 1 }) {
            let name: String = part
                .trim()
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            names.push(name);
        }
    }
    names
}

/// Names re-exported at the crate's root, by the layer they live in.
fn layer_of(name: &str) -> &str {
    match name {
        "MedialMesh" | "MedialPrimitive" | "MedialSphere" => "medial",
        other => other,
    }
}

#[test]
fn imports_go_down_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut checked = 0;
    for (layer, allowed) in LAYERS {
        for path in sources(&src.join(layer)) {
            for (number, line) in code_lines(&path).iter().enumerate() {
                for name in imports(line) {
                    checked += 1;
                    assert!(
                        allowed.contains(&layer_of(&name)),
                        "{}:{}: `{layer}` imports `{name}`",
                        path.display(),
                        number + 1
                    );
                }
            }
        }
    }
    assert!(checked > 50, "the check found only {checked} imports");
}

/// Files of a room: those in its folder, or the one of its name.
fn files_of(layer: &Path, room: &str) -> Vec<PathBuf> {
    let folder = layer.join(room);
    match folder.is_dir() {
        true => sources(&folder),
        false => vec![layer.join(format!("{room}.rs"))],
    }
}

#[test]
fn every_file_of_the_dispatcher_and_the_hook_is_in_a_room() {
    for layer in ["parry", "rapier"] {
        let src = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("src")
            .join(layer);
        let (_, rooms) = ROOMS.iter().find(|(l, _)| *l == layer).expect("rooms");
        for entry in fs::read_dir(src).expect("a source folder") {
            let path = entry.expect("an entry").path();
            let stem = path.file_stem().and_then(|s| s.to_str()).expect("a name");
            assert!(stem == "mod" || rooms.contains(&stem), "{stem} has no room");
        }
    }
}

#[test]
fn rooms_import_from_rooms_before_them_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut checked = 0;
    for (layer, rooms) in ROOMS {
        let prefix = format!("crate::{layer}::");
        for (place, room) in rooms.iter().enumerate() {
            for path in files_of(&src.join(layer), room) {
                for line in code_lines(&path) {
                    let beside = if path.parent() == Some(&src.join(layer)) {
                        "use super::"
                    } else {
                        &prefix
                    };
                    let named = line
                        .split(&prefix)
                        .skip(1)
                        .chain(line.split(beside).skip(1));
                    let named = named.filter_map(|rest| {
                        let name = rest.split(|c: char| !(c.is_alphanumeric() || c == '_'));
                        let name = name.into_iter().next()?;
                        rooms.iter().position(|r| *r == name)
                    });
                    for other in named {
                        checked += 1;
                        assert!(
                            other <= place,
                            "{}: `{room}` imports `{}`",
                            path.display(),
                            rooms[other]
                        );
                    }
                }
            }
        }
    }
    assert!(checked > 300, "the check found only {checked} imports");
}

#[test]
fn libraries_stay_in_their_layer() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for path in sources(&root.join("src")) {
        let relative = path.strip_prefix(root).expect("inside the crate");
        if relative.starts_with("src/bin") {
            continue;
        }
        for (number, line) in code_lines(&path).iter().enumerate() {
            for (library, home) in CONFINED {
                let named = line.match_indices(library).any(|(at, _)| {
                    let rest = &line[at + library.len()..];
                    let before = line[..at].chars().next_back();
                    let whole = !before.is_some_and(|c| c.is_alphanumeric() || c == '_');
                    whole
                        && (rest.starts_with("::") || library == "QueryDispatcher")
                        && !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_')
                });
                let at_home = relative.starts_with(home)
                    || (library == "QueryDispatcher" && relative.starts_with("src/rapier"));
                assert!(
                    !named || at_home,
                    "{}:{}: `{library}` belongs to {home}",
                    relative.display(),
                    number + 1
                );
            }
        }
    }
}

#[test]
fn files_open_with_what_they_are_and_stay_short() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for path in sources(&src) {
        let text = fs::read_to_string(&path).expect("a readable source");
        assert!(text.starts_with("//!"), "{} has no header", path.display());
        let lines = text.lines().count();
        assert!(lines <= LONGEST, "{} has {lines} lines", path.display());
    }
}

/// The functions of a formatted source, each by its first line and how many it has: it ends with a brace as far in.
fn functions(text: &str) -> Vec<(&str, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let indent = |line: &str| line.len() - line.trim_start().len();
    let is_first = |line: &str| {
        let qualifiers = ["const", "async", "unsafe"];
        let (before_name, _) = line.trim_start().split_once("fn ").unwrap_or(("//", ""));
        let mut words = before_name.split_whitespace();
        words.all(|w| w.starts_with("pub") || qualifiers.contains(&w))
    };
    let first = (0..lines.len()).filter(|&i| is_first(lines[i]));
    let of = |i: usize| {
        let is_end = |l: &&str| indent(l) == indent(lines[i]) && l.ends_with(['}', ';']);
        let end = lines[i..].iter().position(is_end);
        (lines[i].trim(), end.map_or(1, |n| n + 1))
    };
    first.map(of).collect()
}

#[test]
fn functions_stay_short() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = 0;
    for path in sources(&src) {
        let text = fs::read_to_string(&path).expect("a readable source");
        for (line, length) in functions(&text) {
            found += 1;
            let is_long = length > LONGEST_FUNCTION;
            assert!(!is_long, "{}: {length} lines: {line}", path.display());
        }
    }
    assert!(found > 1000, "only {found} functions were found");
}

#[test]
fn comments_keep_to_their_columns() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["src", "tests", "examples", "benches"] {
        for path in sources(&root.join(folder)) {
            let text = fs::read_to_string(&path).expect("a readable source");
            for (number, line) in text.lines().enumerate() {
                let is_comment = line.trim_start().starts_with("//");
                let width = line.chars().count();
                let place = format!("{}:{}", path.display(), number + 1);
                assert!(!is_comment || width <= WIDEST, "{place}: {width} columns");
            }
        }
    }
}

/// The numbers in a text, as they are written but for the commas of thousands; a sign counts only in
/// an exponent. What stands in backticks is no measurement, nor are numbers of figures and tables.
fn numbers(text: &str) -> Vec<String> {
    let text = text.split('`').step_by(2).collect::<String>();
    let mut found = Vec::new();
    let mut last = "";
    for word in text.split([
        ' ', '|', '/', '(', ')', '\n', '"', '[', ']', ':', ';', '−', '+', '%',
    ]) {
        let named = last.starts_with("Figure") || last.starts_with("Table");
        if !word.is_empty() {
            last = word;
        }
        let word = word.trim_matches(|c: char| !c.is_ascii_digit());
        let plain = word.replace(',', "");
        if !named && plain.parse::<f64>().is_ok() {
            found.push(plain);
        }
    }
    found
}

/// `docs/measurements/accuracy.md` tells of one run, whose tables are `accuracy.csv` beside it: each of its table rows
/// takes its numbers from one row of the run, each number of its text is one of the run's.
#[test]
fn accuracy_page_has_only_numbers_of_its_run() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/measurements");
    let read = |name: &str| fs::read_to_string(docs.join(name)).expect("a file of docs");
    let run = read("accuracy.csv");
    // Commas part the cells there; those within quotes stay in front of a space.
    let rows: Vec<Vec<String>> = run.lines().map(|l| numbers(&l.replace(',', " "))).collect();
    let page = read("accuracy.md");
    let mut checked = 0;
    for line in page.lines() {
        let wanted = numbers(line);
        let within = |row: &Vec<String>| wanted.iter().all(|n| row.contains(n));
        if line.starts_with('|') {
            assert!(
                rows.iter().any(within),
                "no row of the run has all of: {line}"
            );
        } else {
            let missing = wanted
                .iter()
                .find(|n| !rows.iter().flatten().any(|m| m == *n));
            assert_eq!(missing, None, "not of the run: {line}");
        }
        checked += wanted.len();
    }
    assert!(checked > 100, "only {checked} numbers were found");
}
