//! Reads data sets.

mod images;
mod slip;
mod targets;
mod taxels;

use super::data::DataSet;
use super::definition::Definition;
use feeler_console::CommandError;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// Reads the data set in `folder`.
///
/// # Errors
/// If a file cannot be read.
pub fn read(definition: &Definition, folder: &Path) -> Result<DataSet, CommandError> {
    let mut files = Vec::new();
    let mut set = match (&definition.slip, &definition.values) {
        (Some(slip), _) => slip::read(slip, folder, &mut files)?,
        (_, Some(values)) => match (&values.taxels, &values.images) {
            (Some(taxels), _) => taxels::read(taxels, &values.targets, folder, &mut files)?,
            (_, Some(images)) => images::read(images, &values.targets, folder, &mut files)?,
            _ => return Err("no data".into()),
        },
        _ => return Err("no data".into()),
    };
    set.digest = digest(files)?;
    Ok(set)
}

/// Hash of the contents of `files`, in the order of their names: the first 16 hexadecimal digits of SHA-256.
fn digest(mut files: Vec<PathBuf>) -> Result<String, CommandError> {
    files.sort();
    files.dedup();
    let mut hash = Sha256::new();
    for path in files {
        let bytes = fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(&bytes);
    }
    Ok(hash
        .finalize()
        .iter()
        .take(8)
        .map(|byte| format!("{byte:02x}"))
        .collect())
}
