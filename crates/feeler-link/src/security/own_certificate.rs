//! Checks a program's own certificate before connecting, to report clearer errors than a failed TLS handshake.

use super::files::FileError;
use super::right::{CertificateName, Right, RightError};
use super::validity::{day, now};
use super::withdrawn::{self, WithdrawnError};
use std::fs;
use std::path::{Path, PathBuf};
use x509_parser::certificate::X509Certificate;
use x509_parser::pem::parse_x509_pem;

/// Number of days before expiry at which a program starts to warn.
pub const WARNING_DAYS: u64 = 30;

/// Error of a program's own certificate.
#[derive(Debug, thiserror::Error)]
pub enum OwnCertificateError {
    /// The file cannot be read.
    #[error("--certificates: {0}; expected a folder created by feeler certificates")]
    File(#[from] FileError),
    /// Not a certificate.
    #[error("--certificates: {}: expected a PEM certificate", path.display())]
    Malformed {
        /// Path of the file.
        path: PathBuf,
    },
    /// The common name contains no right.
    #[error("--certificates: {}: {source}; issue a new one with feeler certificates", path.display())]
    Name {
        /// Path of the file.
        path: PathBuf,
        /// Error of the common name.
        source: RightError,
    },
    /// The certificate grants another right.
    #[error("--certificates: {} is {name}; expected one of {expected}", path.display())]
    Right {
        /// Path of the file.
        path: PathBuf,
        /// Name of the certificate.
        name: CertificateName,
        /// Rights that the program accepts; the certificate must grant one.
        expected: String,
    },
    /// Expired, or not valid yet.
    #[error(
        "--certificates: {} is valid from {from} to {until}, but today is {today}; issue a new one with feeler \
         certificates --renew, or set the clock",
        path.display()
    )]
    Invalid {
        /// Path of the file.
        path: PathBuf,
        /// First day of validity.
        from: String,
        /// Last day of validity.
        until: String,
        /// Today's date by this computer's clock.
        today: String,
    },
    /// Revoked by the lab.
    #[error(
        "--certificates: {} is {name}, which the lab has withdrawn; issue a new one with feeler certificates --renew",
        path.display()
    )]
    Withdrawn {
        /// Path of the file.
        path: PathBuf,
        /// Name of the certificate.
        name: CertificateName,
    },
    /// The list of revoked certificates cannot be read.
    #[error(transparent)]
    List(#[from] WithdrawnError),
}

/// Name and validity of a program's own certificate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnCertificate {
    /// Right and serial number.
    pub name: CertificateName,
    from: u64,
    until: u64,
}

impl OwnCertificate {
    /// Reads the certificate in `folder`, and checks that it is valid and grants one of `rights`.
    ///
    /// # Errors
    /// Returns an error if the certificate cannot be used.
    pub fn read(folder: &Path, rights: &[Right]) -> Result<Self, OwnCertificateError> {
        let path = folder.join("cert.pem");
        let own = parse(&path)?;
        let name = own.name;
        if !rights.contains(&name.right) {
            let expected: Vec<String> = rights.iter().map(ToString::to_string).collect();
            let expected = expected.join(", ");
            return Err(OwnCertificateError::Right {
                path,
                name,
                expected,
            });
        }
        if !(own.from..=own.until).contains(&now()) {
            return Err(OwnCertificateError::Invalid {
                path,
                from: day(own.from),
                until: day(own.until),
                today: day(now()),
            });
        }
        if withdrawn::beside(folder)?.contains(&name) {
            return Err(OwnCertificateError::Withdrawn { path, name });
        }
        Ok(own)
    }

    /// Returns a warning if the certificate expires within `WARNING_DAYS`.
    pub fn warning(&self) -> Option<String> {
        let days = self.until.saturating_sub(now()) / (24 * 60 * 60);
        let (name, until) = (self.name, day(self.until));
        (days <= WARNING_DAYS).then(|| {
            format!(
                "certificate {name} expires on {until}: renew it with feeler certificates --renew"
            )
        })
    }
}

fn parse(path: &Path) -> Result<OwnCertificate, OwnCertificateError> {
    let text = fs::read(path).map_err(FileError::at(path))?;
    let malformed = || OwnCertificateError::Malformed {
        path: path.to_path_buf(),
    };
    let (_, pem) = parse_x509_pem(&text).map_err(|_| malformed())?;
    let certificate = pem.parse_x509().map_err(|_| malformed())?;
    let name = name(&certificate).ok_or_else(malformed)?;
    let name = name.parse().map_err(|source| OwnCertificateError::Name {
        path: path.to_path_buf(),
        source,
    })?;
    let validity = certificate.validity();
    // Times before 1970 count as 1970.
    let seconds = |time: i64| u64::try_from(time).unwrap_or(0);
    Ok(OwnCertificate {
        name,
        from: seconds(validity.not_before.timestamp()),
        until: seconds(validity.not_after.timestamp()),
    })
}

/// Returns the first common name, which is the one that Zenoh checks.
pub(crate) fn name<'a>(certificate: &X509Certificate<'a>) -> Option<&'a str> {
    let name = certificate.subject.iter_common_name().next()?;
    name.as_str().ok()
}
