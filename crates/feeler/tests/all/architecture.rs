//! Modules of this crate import only those that ARCHITECTURE.md allows. Between crates, the compiler enforces this.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Each module of `src/` and the modules that it may import.
const MAY_IMPORT: [(&str, &[&str]); 4] = [
    ("control", &["check", "hand", "math", "pace", "sensor"]),
    ("sensor", &["check", "math"]),
    ("hand", &["check", "math"]),
    ("pace", &["check"]),
];

#[test]
fn modules_import_only_allowed_modules() {
    let table: BTreeMap<_, _> = MAY_IMPORT.into_iter().collect();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&source, &mut files);
    assert!(files.len() > 40, "{} files found", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&source).unwrap();
        let module = module_of(inside);
        let Some(module) = module else { continue };
        let allowed = table
            .get(module.as_str())
            .unwrap_or_else(|| panic!("src/{module} is not listed in MAY_IMPORT"));
        for imported in imports(&fs::read_to_string(&file).unwrap()) {
            if imported != module && !allowed.contains(&imported.as_str()) {
                wrong.push(format!("src/{} imports {imported}", inside.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn imports_are_parsed() {
    let text = "use crate::sim::rig::Rig;\n// crate::report\nlet a = crate::hand::finger::X;\n";
    assert_eq!(imports(text), ["sim", "hand"]);
    assert_eq!(
        imports("use crate::{control, sim::rig};"),
        ["control", "sim"]
    );
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// Module of a file below `src/`, or `None` for `lib.rs`, which only declares modules.
fn module_of(inside: &Path) -> Option<String> {
    let mut parts = inside.components();
    let first = parts.next()?.as_os_str().to_str()?.to_string();
    parts.next().is_some().then_some(first)
}

/// Modules that a file names after `crate::`, outside of comments and documentation.
fn imports(text: &str) -> Vec<String> {
    let code = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let code = code.collect::<Vec<_>>().join("\n");
    let mut modules = Vec::new();
    for after in code.split("crate::").skip(1) {
        match after.strip_prefix('{') {
            Some(list) => modules.extend(first_names(list)),
            None => modules.push(name(after)),
        }
    }
    modules
}

/// First name of each path of a braced list, without nested lists.
fn first_names(list: &str) -> Vec<String> {
    let (mut depth, mut names, mut start) = (0, Vec::new(), true);
    for (index, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => start = true,
            c if start && c.is_alphanumeric() => {
                names.push(name(&list[index..]));
                start = false;
            }
            _ => {}
        }
    }
    names
}

fn name(text: &str) -> String {
    text.chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}
