//! Certificate authority of a lab. Its certificates admit programs to the link and grant their rights.

pub use super::certificate_error::CertificateError;
pub use super::certificate_list::Listed;
use super::files::FileError;
use super::register::Register;
use super::right::{CertificateName, Right};
use super::validity::{AUTHORITY_DAYS, Validity};
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose,
};
use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// File names of the authority's certificate and key in the lab's folder.
const AUTHORITY: [&str; 2] = ["ca.pem", "ca-key.pem"];

/// Certificate authority of a lab.
pub struct Authority {
    pub(crate) lab: PathBuf,
    certificate: String,
    issuer: Issuer<'static, KeyPair>,
    pub(crate) register: Register,
}

impl Authority {
    /// Opens the authority in the folder `lab`, or creates it if it does not exist.
    ///
    /// # Errors
    /// If the folder cannot be read or written, or the authority's files are invalid.
    pub fn open_or_make(lab: &Path) -> Result<Self, CertificateError> {
        let [certificate_path, key_path] = AUTHORITY.map(|name| lab.join(name));
        if !certificate_path.exists() && !key_path.exists() {
            fs::create_dir_all(lab).map_err(FileError::at(lab))?;
            let key = KeyPair::generate().map_err(signing(lab))?;
            let certificate = authority().and_then(|a| a.self_signed(&key));
            let certificate = certificate.map_err(signing(lab))?;
            write_new(&key_path, &key.serialize_pem())?;
            write_new(&certificate_path, &certificate.pem())?;
        }
        Self::open(lab)
    }

    /// Opens the authority in the folder `lab`.
    ///
    /// # Errors
    /// If the folder contains no valid authority.
    pub fn open(lab: &Path) -> Result<Self, CertificateError> {
        let [certificate_path, key_path] = AUTHORITY.map(|name| lab.join(name));
        if !certificate_path.exists() && !key_path.exists() {
            let lab = lab.to_path_buf();
            return Err(CertificateError::NoLab { lab });
        }
        let read = |path: &Path| fs::read_to_string(path).map_err(FileError::at(path));
        let certificate = read(&certificate_path)?;
        let key = KeyPair::from_pem(&read(&key_path)?).map_err(signing(lab))?;
        let issuer = Issuer::from_ca_cert_pem(&certificate, key).map_err(signing(lab))?;
        Ok(Self {
            lab: lab.to_path_buf(),
            certificate,
            issuer,
            register: Register::read(lab)?,
        })
    }

    /// Issues one certificate per right for `computer` (host name or address), and returns their names. They are stored
    /// in `LAB/COMPUTER/RIGHT`.
    ///
    /// # Errors
    /// If the computer already has one of them, its name is invalid, or the folder cannot be written.
    pub fn certify(
        &mut self,
        computer: &str,
        rights: &[Right],
        validity: Validity,
    ) -> Result<Vec<CertificateName>, CertificateError> {
        let folder = self.folder(computer)?;
        let folders = rights.iter().map(|right| folder.join(right.to_string()));
        if let Some(path) = folders.into_iter().find(|path| path.exists()) {
            return Err(CertificateError::Exists { path });
        }
        let make = |right: &Right| self.make(computer, *right, validity);
        let names = rights.iter().map(make).collect::<Result<_, _>>()?;
        self.hand_out_withdrawn()?;
        Ok(names)
    }

    /// Issues new certificates, under new names, for those of `computer` that grant one of `rights`. The old ones stay
    /// valid until they expire or are revoked.
    ///
    /// # Errors
    /// If the computer has no such certificate, or the folder cannot be written.
    pub fn renew(
        &mut self,
        computer: &str,
        rights: &[Right],
        validity: Validity,
    ) -> Result<Vec<CertificateName>, CertificateError> {
        let old: BTreeSet<Right> = self
            .register
            .of(computer, rights)
            .map(|entry| entry.name.right)
            .collect();
        if old.is_empty() {
            return Err(none(computer, rights));
        }
        let make = |right| self.make(computer, right, validity);
        old.into_iter().map(make).collect()
    }

    /// Returns the folder of `computer`.
    ///
    /// # Errors
    /// If the name is invalid.
    pub fn folder(&self, computer: &str) -> Result<PathBuf, CertificateError> {
        let sound = |c: char| c.is_ascii_alphanumeric() || ".:-".contains(c);
        if computer.is_empty() || computer.starts_with('.') || !computer.chars().all(sound) {
            let computer = computer.to_string();
            return Err(CertificateError::Computer { computer });
        }
        Ok(self.lab.join(computer))
    }

    /// Issues a certificate and replaces any previous one for the same right.
    fn make(
        &mut self,
        computer: &str,
        right: Right,
        validity: Validity,
    ) -> Result<CertificateName, CertificateError> {
        let folder = self.folder(computer)?;
        let path = folder.join(right.to_string());
        let new = folder.join(format!(".{right}.new"));
        let name = self.register.add(right, computer, &validity.last_day())?;
        let key = KeyPair::generate().map_err(signing(&self.lab))?;
        let certificate = of_computer(computer, name, validity);
        let certificate = certificate.and_then(|c| c.signed_by(&key, &self.issuer));
        let certificate = certificate.map_err(signing(&self.lab))?;
        remove(&new)?;
        fs::create_dir_all(&new).map_err(FileError::at(&new))?;
        write_new(&new.join("ca.pem"), &self.certificate)?;
        write_new(&new.join("cert.pem"), &certificate.pem())?;
        write_new(&new.join("key.pem"), &key.serialize_pem())?;
        // Certificate and key belong together, so the folder is replaced as a whole.
        remove(&path)?;
        fs::rename(&new, &path).map_err(FileError::at(&path))?;
        Ok(name)
    }
}

/// Returns a function that adds the folder `lab` to an error of the certificate library.
fn signing(lab: &Path) -> impl FnOnce(rcgen::Error) -> CertificateError {
    let path = lab.to_path_buf();
    move |source| CertificateError::Signing { path, source }
}

fn authority() -> Result<CertificateParams, rcgen::Error> {
    let mut authority = CertificateParams::new(Vec::new())?;
    Validity::days(AUTHORITY_DAYS).set(&mut authority);
    authority.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    authority.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    let name = &mut authority.distinguished_name;
    name.push(DnType::CommonName, "feeler lab");
    Ok(authority)
}

/// Returns the parameters of a certificate, valid for the computer's name and for local connections.
fn of_computer(
    computer: &str,
    name: CertificateName,
    validity: Validity,
) -> Result<CertificateParams, rcgen::Error> {
    let names = [computer, "localhost", "127.0.0.1"].map(String::from);
    let mut certificate = CertificateParams::new(names)?;
    validity.set(&mut certificate);
    certificate.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    certificate.extended_key_usages = vec![ExtendedKeyUsagePurpose::ClientAuth];
    // Only the hand accepts connections.
    if name.right == Right::Hand {
        let usages = &mut certificate.extended_key_usages;
        usages.push(ExtendedKeyUsagePurpose::ServerAuth);
    }
    certificate.use_authority_key_identifier_extension = true;
    let common_name = name.to_string();
    let name = &mut certificate.distinguished_name;
    name.push(DnType::CommonName, common_name);
    Ok(certificate)
}

/// Removes a folder if it exists.
fn remove(path: &Path) -> Result<(), CertificateError> {
    match fs::remove_dir_all(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(FileError::at(path)(e).into()),
        _ => Ok(()),
    }
}

pub(crate) fn none(computer: &str, rights: &[Right]) -> CertificateError {
    let rights: Vec<String> = rights.iter().map(ToString::to_string).collect();
    CertificateError::None {
        computer: computer.into(),
        rights: rights.join(", "),
    }
}

/// Creates a file that only its owner may read. Fails if the file exists.
fn write_new(path: &Path, text: &str) -> Result<(), CertificateError> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let written = options.open(path);
    let written = written.and_then(|mut file| file.write_all(text.as_bytes()));
    Ok(written.map_err(FileError::at(path))?)
}
