//! File that lists the certificates issued by a lab: one per line, oldest first.

use super::files::{FileError, append, read_if_present};
use super::right::{CertificateName, MAX_SERIAL, Right, RightError};
use std::path::{Path, PathBuf};

/// File name of the list.
const REGISTER: &str = "register.txt";

/// Issued certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Name of the certificate.
    pub name: CertificateName,
    /// Computer that it was issued for.
    pub computer: String,
    /// Last day of validity, e.g. 2027-11-22.
    pub until: String,
}

/// Error of the list of issued certificates.
#[derive(Debug, thiserror::Error)]
pub enum RegisterError {
    /// The file cannot be read or written.
    #[error("{0}; expected the list of the lab's certificates")]
    File(#[from] FileError),
    /// Invalid line.
    #[error(
        "{}, line {line}: {given:?}; expected name, computer and last day, e.g. sense-0.17 10.0.0.6 2027-11-22{}",
        path.display(), source.as_ref().map(|e| format!(": {e}")).unwrap_or_default()
    )]
    Line {
        /// Path of the file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Content of the line.
        given: String,
        /// Error of the certificate's name, if the name is invalid.
        source: Option<RightError>,
    },
    /// All serial numbers of a right are in use.
    #[error(
        "{right} already has {MAX_SERIAL} certificates, the maximum of a lab; create a new lab folder with new \
         certificates for all computers"
    )]
    Full {
        /// The right.
        right: Right,
    },
}

/// List of the certificates issued by a lab.
#[derive(Debug)]
pub struct Register {
    path: PathBuf,
    entries: Vec<Entry>,
}

impl Register {
    /// Reads the list in the folder `lab`. It is empty if the file does not exist.
    ///
    /// # Errors
    /// If the file exists but cannot be read or parsed.
    pub fn read(lab: &Path) -> Result<Self, RegisterError> {
        let path = lab.join(REGISTER);
        let text = read_if_present(&path)?;
        let lines = (1..).zip(text.lines());
        let lines = lines.filter(|(_, given)| !given.trim().is_empty());
        let entry = |(line, given): (usize, &str)| {
            entry(given).map_err(|source| RegisterError::Line {
                path: path.clone(),
                line,
                given: given.into(),
                source,
            })
        };
        let entries = lines.map(entry).collect::<Result<_, _>>()?;
        Ok(Self { path, entries })
    }

    /// Returns all certificates, oldest first.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Returns the certificates of `computer` that grant one of `rights`.
    pub fn of<'a>(
        &'a self,
        computer: &'a str,
        rights: &'a [Right],
    ) -> impl Iterator<Item = &'a Entry> {
        let of_rights = |e: &&Entry| rights.contains(&e.name.right);
        self.entries
            .iter()
            .filter(move |e| e.computer == computer)
            .filter(of_rights)
    }

    /// Adds a certificate for `right` and `computer`, and returns its new name. Call this before issuing the
    /// certificate: a failure may then leave a name unused, but no name is used twice.
    ///
    /// # Errors
    /// If all serial numbers are in use, or the file cannot be written.
    pub fn add(
        &mut self,
        right: Right,
        computer: &str,
        until: &str,
    ) -> Result<CertificateName, RegisterError> {
        let of_right = self.entries.iter().filter(|e| e.name.right == right);
        let serial = 1 + of_right.map(|e| e.name.serial).max().unwrap_or(0);
        if serial > MAX_SERIAL {
            return Err(RegisterError::Full { right });
        }
        let name = CertificateName { right, serial };
        append(&self.path, &format!("{name} {computer} {until}\n"))?;
        self.entries.push(Entry {
            name,
            computer: computer.into(),
            until: until.into(),
        });
        Ok(name)
    }
}

/// Parses a line. Returns the error of the name, or `None` as the error if the number of words is wrong.
fn entry(line: &str) -> Result<Entry, Option<RightError>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [name, computer, until] = words[..] else {
        return Err(None);
    };
    Ok(Entry {
        name: name.parse().map_err(Some)?,
        computer: computer.into(),
        until: until.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn serials_increase_per_right_and_are_not_reused() {
        let lab = std::env::temp_dir().join(format!("feeler-register-{}", std::process::id()));
        fs::create_dir_all(&lab).unwrap();
        let mut register = Register::read(&lab).unwrap();
        let mut add = |right, computer| {
            let name = register.add(right, computer, "2027-11-22").unwrap();
            name.to_string()
        };
        assert_eq!(add(Right::Hand, "a"), "hand.1");
        assert_eq!(add(Right::Sense(1), "b"), "sense-1.1");
        assert_eq!(add(Right::Hand, "b"), "hand.2");
        let mut read = Register::read(&lab).unwrap();
        assert_eq!(read.entries(), register.entries());
        assert_eq!(read.of("b", &[Right::Hand]).count(), 1);
        let again = read.add(Right::Hand, "a", "2028-11-22").unwrap();
        assert_eq!(again.to_string(), "hand.3");

        append(&lab.join(REGISTER), "hand.999 c 2027-11-22\n").unwrap();
        let full = Register::read(&lab).unwrap().add(Right::Hand, "a", "x");
        assert!(matches!(full, Err(RegisterError::Full { .. })), "{full:?}");
        append(&lab.join(REGISTER), "hand.4 c\n").unwrap();
        let error = Register::read(&lab).unwrap_err().to_string();
        assert!(error.contains("line 6: \"hand.4 c\""), "{error}");
        fs::remove_dir_all(&lab).unwrap();
    }
}
