//! Errors of issuing and revoking certificates.

use super::files::FileError;
use super::register::RegisterError;
use super::withdrawn::WithdrawnError;
use std::path::PathBuf;

/// Error of issuing or revoking certificates.
#[derive(Debug, thiserror::Error)]
pub enum CertificateError {
    /// A file cannot be read or written.
    #[error("{0}; expected a writable folder")]
    File(#[from] FileError),
    /// Invalid name of a computer.
    #[error(
        "invalid computer name {computer:?}: expected letters, digits, dots, colons and hyphens"
    )]
    Computer {
        /// The invalid name.
        computer: String,
    },
    /// The computer already has a certificate for this right.
    #[error("{}: certificate already exists; use --renew to replace it", path.display())]
    Exists {
        /// Folder of the certificate.
        path: PathBuf,
    },
    /// The folder contains no certificate authority.
    #[error("{}: no certificate authority; expected a lab folder created by feeler certificates", lab.display())]
    NoLab {
        /// The lab's folder.
        lab: PathBuf,
    },
    /// No certificate to revoke or renew.
    #[error("{computer} has no certificate for {rights}; --list shows all certificates")]
    None {
        /// Name of the computer.
        computer: String,
        /// Requested rights.
        rights: String,
    },
    /// The authority's files are invalid, or signing failed.
    #[error("{}: {source}", path.display())]
    Signing {
        /// The lab's folder.
        path: PathBuf,
        /// Error of the certificate library.
        source: rcgen::Error,
    },
    /// The list of issued certificates is invalid.
    #[error(transparent)]
    Register(#[from] RegisterError),
    /// The list of revoked certificates is invalid.
    #[error(transparent)]
    Withdrawn(#[from] WithdrawnError),
}
