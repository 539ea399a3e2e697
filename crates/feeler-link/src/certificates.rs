//! A lab's own certificate authority: who has a certificate of it takes part, nobody else does.

use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose,
};
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The authority's certificate and its key, in the lab's folder.
const AUTHORITY: [&str; 2] = ["ca.pem", "ca-key.pem"];

/// Why certificates could not be made.
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
    /// The computer has certificates.
    #[error("{} is there already; remove it to make it again", path.display())]
    Exists {
        /// Its folder.
        path: PathBuf,
    },
    /// The authority in the folder is none, or nothing can be signed.
    #[error("{}: {source}", path.display())]
    Signing {
        /// The lab's folder.
        path: PathBuf,
        /// What the library said.
        source: rcgen::Error,
    },
}

/// A lab's authority.
pub struct Authority {
    lab: PathBuf,
    certificate: String,
    issuer: Issuer<'static, KeyPair>,
}

impl Authority {
    /// The authority of the folder `lab`; it is made when there is none.
    ///
    /// # Errors
    /// When the folder cannot be read or written, or holds something else.
    pub fn open_or_make(lab: &Path) -> Result<Self, CertificateError> {
        let signing = |source| CertificateError::Signing {
            path: lab.to_path_buf(),
            source,
        };
        let [certificate_path, key_path] = AUTHORITY.map(|name| lab.join(name));
        if !certificate_path.exists() && !key_path.exists() {
            fs::create_dir_all(lab).map_err(|e| failed(lab, e))?;
            let key = KeyPair::generate().map_err(signing)?;
            let certificate = authority()
                .and_then(|a| a.self_signed(&key))
                .map_err(signing)?;
            write_new(&key_path, &key.serialize_pem())?;
            write_new(&certificate_path, &certificate.pem())?;
        }
        let read = |path: &Path| fs::read_to_string(path).map_err(|e| failed(path, e));
        let certificate = read(&certificate_path)?;
        let key = KeyPair::from_pem(&read(&key_path)?).map_err(signing)?;
        let issuer = Issuer::from_ca_cert_pem(&certificate, key).map_err(signing)?;
        Ok(Self {
            lab: lab.to_path_buf(),
            certificate,
            issuer,
        })
    }

    /// Makes the certificates of `computer` (a name or an address), in the folder of that name; the folder.
    ///
    /// # Errors
    /// When it has some, its name is none, or the folder cannot be written.
    pub fn certify(&self, computer: &str) -> Result<PathBuf, CertificateError> {
        let sound = |c: char| c.is_ascii_alphanumeric() || ".:-".contains(c);
        if computer.is_empty() || computer.starts_with('.') || !computer.chars().all(sound) {
            let computer = computer.to_string();
            return Err(CertificateError::Computer { computer });
        }
        let path = self.lab.join(computer);
        if path.exists() {
            return Err(CertificateError::Exists { path });
        }
        let signing = |source| CertificateError::Signing {
            path: self.lab.clone(),
            source,
        };
        let key = KeyPair::generate().map_err(signing)?;
        let certificate = of_computer(computer).and_then(|c| c.signed_by(&key, &self.issuer));
        let certificate = certificate.map_err(signing)?;
        fs::create_dir(&path).map_err(|e| failed(&path, e))?;
        write_new(&path.join("ca.pem"), &self.certificate)?;
        write_new(&path.join("cert.pem"), &certificate.pem())?;
        write_new(&path.join("key.pem"), &key.serialize_pem())?;
        Ok(path)
    }
}

fn authority() -> Result<CertificateParams, rcgen::Error> {
    let mut authority = CertificateParams::new(Vec::new())?;
    authority.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    authority.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    let name = &mut authority.distinguished_name;
    name.push(DnType::CommonName, "feeler lab");
    Ok(authority)
}

/// A computer is known by its name, and by itself.
fn of_computer(computer: &str) -> Result<CertificateParams, rcgen::Error> {
    let names = [computer, "localhost", "127.0.0.1"].map(String::from);
    let mut certificate = CertificateParams::new(names)?;
    certificate.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    // Every program listens and connects.
    certificate.extended_key_usages = vec![
        ExtendedKeyUsagePurpose::ServerAuth,
        ExtendedKeyUsagePurpose::ClientAuth,
    ];
    certificate.use_authority_key_identifier_extension = true;
    let name = &mut certificate.distinguished_name;
    name.push(DnType::CommonName, computer);
    Ok(certificate)
}

/// Writes a file that is not there yet and that nobody else may read.
fn write_new(path: &Path, text: &str) -> Result<(), CertificateError> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let written = options.open(path);
    written
        .and_then(|mut file| file.write_all(text.as_bytes()))
        .map_err(|e| failed(path, e))
}

fn failed(path: &Path, source: io::Error) -> CertificateError {
    CertificateError::File {
        path: path.to_path_buf(),
        source,
    }
}
