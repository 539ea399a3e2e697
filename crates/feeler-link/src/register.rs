//! The certificates that a lab has made: a list in a file of its folder, one a line, in the order of making.

use super::right::{CertificateName, MOST_SERIAL, Right, RightError};
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Name of the list.
const REGISTER: &str = "register.txt";

/// A certificate that was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its name.
    pub name: CertificateName,
    /// The computer that it was made for.
    pub computer: String,
    /// The last day on which it is valid, as in 2027-11-22.
    pub until: String,
}

/// Why the list cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RegisterError {
    /// The file cannot be read or written.
    #[error("{}: {source}; expected the list of the lab's certificates", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line is none of the list's.
    #[error(
        "{}, line {line}: {given:?}; expected name, computer and last day, as in sense-0.17 10.0.0.6 2027-11-22{}",
        path.display(), source.as_ref().map(|e| format!(": {e}")).unwrap_or_default()
    )]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What it says.
        given: String,
        /// What is wrong with its name.
        source: Option<RightError>,
    },
    /// All names of a right are given.
    #[error(
        "{right} has had {MOST_SERIAL} certificates, the most that a lab can make; expected a new lab folder, with new \
         certificates for all computers"
    )]
    Full {
        /// The right.
        right: Right,
    },
}

/// The list of a lab.
#[derive(Debug)]
pub struct Register {
    path: PathBuf,
    entries: Vec<Entry>,
}

impl Register {
    /// That of the folder `lab`; empty where there is none yet.
    ///
    /// # Errors
    /// When there is one and it cannot be read.
    pub fn read(lab: &Path) -> Result<Self, RegisterError> {
        let path = lab.join(REGISTER);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == io::ErrorKind::NotFound => String::new(),
            Err(source) => return Err(RegisterError::File { path, source }),
        };
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

    /// All certificates, the oldest first.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Those of `computer` with one of `rights`.
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

    /// Adds a certificate of `right` for `computer`, whose name was never given before. It is on the list before it is
    /// made: a name may be lost, but is not given twice.
    ///
    /// # Errors
    /// When all names are given, or the file cannot be written.
    pub fn add(
        &mut self,
        right: Right,
        computer: &str,
        until: &str,
    ) -> Result<CertificateName, RegisterError> {
        let of_right = self.entries.iter().filter(|e| e.name.right == right);
        let serial = 1 + of_right.map(|e| e.name.serial).max().unwrap_or(0);
        if serial > MOST_SERIAL {
            return Err(RegisterError::Full { right });
        }
        let name = CertificateName { right, serial };
        append(&self.path, &format!("{name} {computer} {until}\n")).map_err(|source| {
            RegisterError::File {
                path: self.path.clone(),
                source,
            }
        })?;
        self.entries.push(Entry {
            name,
            computer: computer.into(),
            until: until.into(),
        });
        Ok(name)
    }
}

/// Adds to a file, which is made where there is none.
pub(super) fn append(path: &Path, text: &str) -> io::Result<()> {
    let mut file = OpenOptions::new().append(true).create(true).open(path)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()
}

/// What a line says; or what is wrong with its name, if that it is.
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

    #[test]
    fn names_count_up_for_each_right_and_are_not_given_twice() {
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
