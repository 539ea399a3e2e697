//! A program's own certificate, looked at before it is used: what is wrong with it is said better here than by a
//! connection that does not come about.

use super::right::{CertificateName, Right, RightError};
use super::validity::{day, now};
use super::withdrawn::{self, WithdrawnError};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use x509_parser::certificate::X509Certificate;
use x509_parser::pem::parse_x509_pem;

/// So long before a certificate expires a program says so, days.
pub const WARNING_DAYS: u64 = 30;

/// Why a program cannot use its certificate.
#[derive(Debug, thiserror::Error)]
pub enum OwnCertificateError {
    /// The file cannot be read.
    #[error("--certificates: {}: {source}; expected a folder that feeler certificates made", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file holds something else.
    #[error("--certificates: {}: expected a certificate, in PEM", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
    },
    /// It says nothing of rights.
    #[error("--certificates: {}: {source}; make a new one with feeler certificates", path.display())]
    Name {
        /// The file.
        path: PathBuf,
        /// What is wrong with its name.
        source: RightError,
    },
    /// It is for something else.
    #[error("--certificates: {} is {name}; expected one of {expected}", path.display())]
    Right {
        /// The file.
        path: PathBuf,
        /// Its name.
        name: CertificateName,
        /// The rights that this program needs one of.
        expected: String,
    },
    /// It is not valid any more, or not yet.
    #[error(
        "--certificates: {} is valid from {from} to {until}, and today is {today}; make a new one with feeler \
         certificates --renew, or set the clock",
        path.display()
    )]
    Invalid {
        /// The file.
        path: PathBuf,
        /// First day.
        from: String,
        /// Last day.
        until: String,
        /// This computer's date.
        today: String,
    },
    /// The lab has withdrawn it.
    #[error("--certificates: {} is {name}, which the lab has withdrawn; make a new one with feeler certificates --renew", path.display())]
    Withdrawn {
        /// The file.
        path: PathBuf,
        /// Its name.
        name: CertificateName,
    },
    /// The list of withdrawn certificates cannot be read.
    #[error(transparent)]
    List(#[from] WithdrawnError),
}

/// What a certificate says of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnCertificate {
    /// Right and number.
    pub name: CertificateName,
    from: u64,
    until: u64,
}

impl OwnCertificate {
    /// The certificate in `folder`, if it is valid and gives one of `rights`.
    ///
    /// # Errors
    /// Why it cannot be used.
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

    /// What to say when it expires soon.
    pub fn warning(&self) -> Option<String> {
        let days = self.until.saturating_sub(now()) / (24 * 60 * 60);
        let (name, until) = (self.name, day(self.until));
        (days <= WARNING_DAYS).then(|| {
            format!("the certificate {name} expires on {until}: renew it with feeler certificates --renew")
        })
    }
}

fn parse(path: &Path) -> Result<OwnCertificate, OwnCertificateError> {
    let read = fs::read(path);
    let text = read.map_err(|source| OwnCertificateError::File {
        path: path.to_path_buf(),
        source,
    })?;
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
    // A time before 1970 is long ago.
    let seconds = |time: i64| u64::try_from(time).unwrap_or(0);
    Ok(OwnCertificate {
        name,
        from: seconds(validity.not_before.timestamp()),
        until: seconds(validity.not_after.timestamp()),
    })
}

/// The first common name, which is also the one that Zenoh looks at.
pub(super) fn name<'a>(certificate: &X509Certificate<'a>) -> Option<&'a str> {
    let name = certificate.subject.iter_common_name().next()?;
    name.as_str().ok()
}
