//! No file imports, over other files, itself: read from the `crate::` and `super::` paths of the source text. What a
//! folder's `mod.rs` re-exports counts as imported from the file where it is.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::{code_lines, sources};

/// A module as its path in the crate: `pair::search`.
type Module = String;

/// The modules of the library, and whether each is a folder's.
fn modules(src: &Path) -> HashMap<Module, (String, bool)> {
    let mut found = HashMap::new();
    for path in sources(src) {
        let relative = path.strip_prefix(src).expect("inside the source");
        let mut names: Vec<_> = relative
            .with_extension("")
            .iter()
            .map(|n| n.to_string_lossy().into_owned())
            .collect();
        if names[0] == "bin" || names == ["lib"] {
            continue;
        }
        let is_folder =
            names.last().is_some_and(|n| n == "mod") || path.with_extension("").is_dir();
        if names.last().is_some_and(|n| n == "mod") {
            names.pop();
        }
        let text = code_lines(&path).join("\n");
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or("");
        found.insert(names.join("::"), (code.to_owned(), is_folder));
    }
    found
}

/// All paths of a use group: `a::{b, c::{d, e}}` gives `a::b`, `a::c::d` and `a::c::e`.
fn expand(prefix: &str, text: &str, into: &mut Vec<String>) {
    let open = text.find(['{', ',', ';', '}', ')', '<', '(', ' ', '\n']);
    let (head, rest) = text.split_at(open.unwrap_or(text.len()));
    if !rest.starts_with('{') {
        into.push(format!("{prefix}{head}"));
        return;
    }
    let mut depth = 0;
    let mut start = 1;
    for (at, c) in rest.char_indices() {
        let ends = match c {
            '{' => {
                depth += 1;
                false
            }
            '}' => {
                depth -= 1;
                depth == 0
            }
            ',' => depth == 1,
            _ => false,
        };
        if ends {
            let item = rest[start..at].trim();
            if !item.is_empty() {
                expand(&format!("{prefix}{head}"), item, into);
            }
            start = at + 1;
        }
        if depth == 0 {
            return;
        }
    }
}

/// Paths in `text` that begin with `keyword`, each put after `base`.
fn paths(text: &str, keyword: &str, base: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(keyword) {
        let before = text[..at].chars().next_back();
        if !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
            expand(base, &text[at + keyword.len()..], &mut found);
        }
    }
    found
}

/// The module that a folder's `pub use` takes each name from.
fn re_exports(modules: &HashMap<Module, (String, bool)>) -> HashMap<String, Module> {
    let mut found = HashMap::new();
    for (folder, (code, _)) in modules.iter().filter(|(_, m)| m.1) {
        for text in code.split("pub use ").skip(1) {
            let mut names = Vec::new();
            expand("", text, &mut names);
            for name in names {
                let Some((child, last)) = name.rsplit_once("::") else {
                    continue;
                };
                let child = format!("{folder}::{child}");
                if modules.contains_key(&child) {
                    found.insert(format!("{folder}::{last}"), child);
                }
            }
        }
    }
    found
}

/// A circle that can be reached from `at`, if there is one.
fn circle<'a>(
    at: &'a str,
    imports: &'a HashMap<Module, HashSet<Module>>,
    way: &mut Vec<&'a str>,
    done: &mut HashSet<&'a str>,
) -> Option<Vec<String>> {
    if let Some(start) = way.iter().position(|m| *m == at) {
        return Some(way[start..].iter().map(|m| (*m).to_owned()).collect());
    }
    if done.contains(at) {
        return None;
    }
    way.push(at);
    let mut next: Vec<_> = imports[at].iter().collect();
    next.sort();
    let found = next.into_iter().find_map(|m| circle(m, imports, way, done));
    way.pop();
    done.insert(at);
    found
}

#[test]
fn no_file_imports_itself_over_others() {
    let modules = modules(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let re_exports = re_exports(&modules);
    let resolve = |path: &str| {
        let mut path = path.trim_end_matches("::");
        loop {
            if let Some(home) = re_exports.get(path) {
                return Some(home.clone());
            }
            if modules.contains_key(path) {
                return Some(path.to_owned());
            }
            path = path.rsplit_once("::")?.0;
        }
    };
    let mut imports = HashMap::new();
    for (name, (code, is_folder)) in &modules {
        let parent = |m: &str| m.rsplit_once("::").map_or("", |(p, _)| p).to_owned();
        let folder = if *is_folder {
            name.clone()
        } else {
            parent(name)
        };
        let above = if *is_folder { parent(&folder) } else { folder };
        let mut named = paths(code, "crate::", "");
        named.extend(paths(code, "super::", &format!("{above}::")));
        let found: HashSet<Module> = named.iter().filter_map(|p| resolve(p)).collect();
        imports.insert(
            name.clone(),
            found.into_iter().filter(|m| m != name).collect(),
        );
    }
    let count: usize = imports.values().map(HashSet::len).sum();
    assert!(count > 500, "the check found only {count} imports");
    let mut done = HashSet::new();
    for module in modules.keys() {
        let found = circle(module, &imports, &mut Vec::new(), &mut done);
        assert_eq!(found, None, "files that import each other");
    }
}
