//! Why certificates could not be made or withdrawn.

use super::register::RegisterError;
use super::withdrawn::WithdrawnError;
use std::io;
use std::path::PathBuf;

/// Why certificates could not be made or withdrawn.
#[derive(Debug, thiserror::Error)]
pub enum CertificateError {
    /// A file cannot be read or written.
    #[error("{}: {source}; expected a folder that can be written to", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A computer's name is none.
    #[error(
        "{computer:?} is no computer's name: expected letters, digits, dots, colons and hyphens"
    )]
    Computer {
        /// What was given.
        computer: String,
    },
    /// The computer has a certificate of that right.
    #[error("{} is there already; expected --renew to make it again", path.display())]
    Exists {
        /// Its folder.
        path: PathBuf,
    },
    /// There is no authority.
    #[error("{}: no lab's authority; expected a folder in which feeler certificates has made some", lab.display())]
    NoLab {
        /// The folder.
        lab: PathBuf,
    },
    /// There is nothing to withdraw or to renew.
    #[error("{computer} has no certificate of {rights}; expected one of those that --list shows")]
    None {
        /// The computer.
        computer: String,
        /// The rights that were asked for.
        rights: String,
    },
    /// The authority in the folder is none, or nothing can be signed.
    #[error("{}: {source}", path.display())]
    Signing {
        /// The lab's folder.
        path: PathBuf,
        /// What the library said.
        source: rcgen::Error,
    },
    /// The list of the lab's certificates cannot be used.
    #[error(transparent)]
    Register(#[from] RegisterError),
    /// The list of withdrawn certificates cannot be used.
    #[error(transparent)]
    Withdrawn(#[from] WithdrawnError),
}
