//! Finds the definitions of data sets: built-in ones, and files next to the data.

use super::definition::Definition;
use feeler_console::CommandError;
use std::fs;
use std::path::{Path, PathBuf};

/// Ending of a definition's file name.
pub const ENDING: &str = ".league.toml";

/// Built-in definitions.
const BUILT_IN: [&str; 11] = [
    include_str!("../../league/eflesh-slip.toml"),
    include_str!("../../league/gelsight-slip.toml"),
    include_str!("../../league/gelsight-slip-150.toml"),
    include_str!("../../league/uskin-grasps.toml"),
    include_str!("../../league/eflesh-normal.toml"),
    include_str!("../../league/eflesh-normal-other-run.toml"),
    include_str!("../../league/eflesh-shear.toml"),
    include_str!("../../league/eflesh-place.toml"),
    include_str!("../../league/optofiber-force.toml"),
    include_str!("../../league/tactip-tap.toml"),
    include_str!("../../league/tactip-shear.toml"),
];

/// A definition with the folder of its data.
#[derive(Debug)]
pub struct SetFiles {
    pub definition: Definition,
    pub folder: PathBuf,
}

/// Returns all definitions: built-in ones with folders in `data`, and files in `data` and its subfolders.
///
/// # Errors
/// If a folder cannot be read, a definition is invalid, or two have the same name.
pub fn find_sets(data: &Path) -> Result<Vec<SetFiles>, CommandError> {
    let mut sets: Vec<SetFiles> = Vec::new();
    for text in BUILT_IN {
        let definition = Definition::from_toml(text)?;
        let folder = data.join(&definition.folder);
        sets.push(SetFiles { definition, folder });
    }
    for path in definition_files(data)? {
        let refused = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let text = fs::read_to_string(&path).map_err(|e| refused(&e))?;
        let definition = Definition::from_toml(&text).map_err(|e| refused(&e))?;
        if sets
            .iter()
            .any(|set| set.definition.name == definition.name)
        {
            let name = &definition.name;
            let message = format!("expected a name that no other set has, got {name:?}; rename it");
            return Err(refused(&message).into());
        }
        let folder = path.parent().unwrap_or(data).join(&definition.folder);
        sets.push(SetFiles { definition, folder });
    }
    Ok(sets)
}

/// Returns the definition files in `data` and its subfolders, sorted.
fn definition_files(data: &Path) -> Result<Vec<PathBuf>, CommandError> {
    let (mut files, folders) = entries(data)?;
    for folder in folders {
        // A subfolder that cannot be listed contains no set.
        files.extend(entries(&folder).map_or(Vec::new(), |(files, _)| files));
    }
    let is_definition = |path: &PathBuf| path.to_string_lossy().ends_with(ENDING);
    files.retain(is_definition);
    Ok(files)
}

/// Returns the files and folders in a folder, sorted.
fn entries(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>), CommandError> {
    let refused = |e| format!("{}: {e}; expected a folder of data", folder.display());
    let found = fs::read_dir(folder).map_err(refused)?;
    let mut paths: Vec<_> = (found.filter_map(Result::ok)).map(|e| e.path()).collect();
    paths.sort();
    let (folders, files) = paths.into_iter().partition(|path| path.is_dir());
    Ok((files, folders))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_definitions_are_valid() {
        for text in BUILT_IN {
            let definition = Definition::from_toml(text).unwrap();
            assert!(!definition.folder.as_os_str().is_empty());
        }
    }
}
