//! File that lists the certificates revoked by a lab, one name per line.

use super::files::{FileError, read_if_present};
use super::right::{CertificateName, RightError};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Name of the file that lists revoked certificates, in the lab's folder and in each certificate folder.
pub const WITHDRAWN: &str = "withdrawn.txt";

/// Error of reading the list of revoked certificates.
#[derive(Debug, thiserror::Error)]
pub enum WithdrawnError {
    /// The file cannot be read.
    #[error("{0}; expected a readable list of withdrawn certificates, or no file")]
    File(#[from] FileError),
    /// Invalid line.
    #[error("{}, line {line}: {source}", path.display())]
    Line {
        /// Path of the file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Error of the certificate name.
        source: RightError,
    },
}

/// Reads the list in the file `path`. The result is empty if the file does not exist.
///
/// # Errors
/// If the file exists but cannot be read or parsed.
pub fn read(path: &Path) -> Result<BTreeSet<CertificateName>, WithdrawnError> {
    let text = read_if_present(path)?;
    parse(&text).map_err(|(line, source)| WithdrawnError::Line {
        path: path.to_path_buf(),
        line,
        source,
    })
}

/// Reads the lists that apply to the certificates in `folder`: the list in `folder`, and the list in its parent folder,
/// which is common to the certificates for all rights.
///
/// # Errors
/// If a list exists but cannot be read or parsed.
pub fn beside(folder: &Path) -> Result<BTreeSet<CertificateName>, WithdrawnError> {
    let mut names = read(&folder.join(WITHDRAWN))?;
    names.extend(read(&folder.join("..").join(WITHDRAWN))?);
    Ok(names)
}

/// Parses the first word of each line, skipping empty lines and `#` comments. The error contains the line number.
fn parse(text: &str) -> Result<BTreeSet<CertificateName>, (usize, RightError)> {
    let mut names = BTreeSet::new();
    for (line, words) in (1..).zip(text.lines()) {
        match words.split_whitespace().next() {
            None => {}
            Some(word) if word.starts_with('#') => {}
            Some(word) => {
                names.insert(word.parse().map_err(|e| (line, e))?);
            }
        }
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_and_errors_contain_the_line() {
        let text = "# of the lab\n\nsense-0.17  10.0.0.6  withdrawn 2026-11-22\n  hand.2\r\n";
        let names = parse(text).unwrap();
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        assert_eq!(names, ["hand.2", "sense-0.17"]);
        let (line, error) = parse("hand.1\nhand\n").unwrap_err();
        assert_eq!(line, 2);
        assert!(error.to_string().contains("as in sense-0.17"), "{error}");
    }
}
