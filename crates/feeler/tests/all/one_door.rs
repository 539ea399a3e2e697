//! Only the controller constructs motion commands, from the velocities that `apply_limits` admits.

use std::fs;
use std::path::{Path, PathBuf};

/// Source files of all crates with their paths below `crates`, and their code without comments.
fn sources() -> Vec<(String, String)> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for entry in fs::read_dir(&crates).expect("the crates") {
        collect(&entry.expect("an entry").path().join("src"), &mut files);
    }
    let code = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("a source file");
        let lines = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        let code = lines.collect::<Vec<_>>().join("\n");
        let name = path.strip_prefix(&crates).expect("a file below crates");
        (name.display().to_string(), code)
    };
    files.into_iter().map(code).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// File of each occurrence of `call` in `sources`.
fn callers<'a>(sources: &'a [(String, String)], call: &str) -> Vec<&'a str> {
    let files = sources.iter();
    let places = files.flat_map(|(name, code)| code.matches(call).map(move |_| name.as_str()));
    places.collect()
}

/// Outside of the crate, the compiler enforces this: the field is private (`HandCommand` has a test that must not
/// compile).
#[test]
fn only_the_controller_sets_velocities_of_a_command() {
    let sources = sources();
    assert!(sources.len() > 200, "{} files found", sources.len());
    let controller = ["feeler/src/control/controller.rs"];
    assert_eq!(callers(&sources, ".admitted_mut("), controller);
}

/// A rig executes commands of the hand program. A program with a controller has no commands to relay.
#[test]
fn only_the_rig_of_a_link_relays_commands() {
    let sources = sources();
    let relays = callers(&sources, ".relay(");
    assert!(!relays.is_empty());
    for file in relays {
        assert!(file.contains("link"), "{file} relays commands");
        let (_, code) = sources.iter().find(|(name, _)| name == file).expect("it");
        assert!(
            !code.contains("Controller"),
            "{file} relays commands and has a controller"
        );
    }
}
