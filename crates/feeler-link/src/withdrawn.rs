//! The certificates that a lab has withdrawn: a list in a file, one name a line.

use super::right::{CertificateName, RightError};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Name of the list, in a lab's folder and in each folder of certificates.
pub const WITHDRAWN: &str = "withdrawn.txt";

/// Why the list cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum WithdrawnError {
    /// The file cannot be read.
    #[error("{}: {source}; expected the list of withdrawn certificates, or no such file", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line is none of the list's.
    #[error("{}, line {line}: {source}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What is wrong with it.
        source: RightError,
    },
}

/// The names that the list of the file `path` withdraws; none where there is no such file.
///
/// # Errors
/// When there is one and it cannot be read: a list that is not understood withdraws nobody.
pub fn read(path: &Path) -> Result<BTreeSet<CertificateName>, WithdrawnError> {
    let path_buf = || path.to_path_buf();
    match fs::read_to_string(path) {
        Ok(text) => parse(&text).map_err(|(line, source)| WithdrawnError::Line {
            path: path_buf(),
            line,
            source,
        }),
        Err(source) if source.kind() == io::ErrorKind::NotFound => Ok(BTreeSet::new()),
        Err(source) => Err(WithdrawnError::File {
            path: path_buf(),
            source,
        }),
    }
}

/// What applies to the certificates in `folder`: the list in it, and the one beside it, which those of all rights share.
///
/// # Errors
/// When a list is there and cannot be read.
pub fn beside(folder: &Path) -> Result<BTreeSet<CertificateName>, WithdrawnError> {
    let mut names = read(&folder.join(WITHDRAWN))?;
    names.extend(read(&folder.join("..").join(WITHDRAWN))?);
    Ok(names)
}

/// The first word of each line that is neither empty nor a comment; or the line and what is wrong with it.
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
    fn each_line_withdraws_one_and_a_line_that_does_not_is_said() {
        let text = "# of the lab\n\nsense-0.17  10.0.0.6  withdrawn 2026-11-22\n  hand.2\r\n";
        let names = parse(text).unwrap();
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        assert_eq!(names, ["hand.2", "sense-0.17"]);
        let (line, error) = parse("hand.1\nhand\n").unwrap_err();
        assert_eq!(line, 2);
        assert!(error.to_string().contains("as in sense-0.17"), "{error}");
    }
}
