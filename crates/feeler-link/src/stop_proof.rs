//! Who calls at the stop door, and whose answer it is: certificates of the lab and signatures by their keys.

use super::own_certificate::name;
use super::right::{CertificateName, Right, RightError};
use super::stop_wire::{Datagram, Proof};
use super::withdrawn::{self, WithdrawnError};
use rcgen::{KeyPair, SigningKey};
use rustls_pki_types::{CertificateDer, UnixTime};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use webpki::ring::ECDSA_P256_SHA256;
use webpki::{EndEntityCert, KeyUsage, anchor_from_trusted_cert};
use x509_parser::pem::parse_x509_pem;
use x509_parser::prelude::{FromDer, X509Certificate};

/// Why nothing can be proven with the certificates of a folder.
#[derive(Debug, thiserror::Error)]
pub enum CredentialsError {
    /// A file cannot be read.
    #[error("{}: {source}; expected a folder that feeler certificates made", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file holds something else.
    #[error("{}: expected a certificate or a key that feeler certificates made", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
    },
    /// The list of withdrawn certificates cannot be read.
    #[error(transparent)]
    Withdrawn(#[from] WithdrawnError),
    /// The key does not sign.
    #[error("the certificate's key does not sign: {0}")]
    Signing(#[from] rcgen::Error),
}

/// Why somebody is not believed.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Denial {
    /// Nothing is shown.
    #[error("no certificate; expected one of this lab")]
    Missing,
    /// What is shown is no certificate.
    #[error("no certificate but something else; expected one of this lab")]
    Malformed,
    /// It says nothing of rights.
    #[error("a certificate without a right: {0}")]
    Name(#[from] RightError),
    /// It gives another right.
    #[error("the certificate is {0}; expected a right to do this")]
    Right(CertificateName),
    /// The lab has withdrawn it.
    #[error("the certificate {0} is withdrawn")]
    Withdrawn(CertificateName),
    /// It is of another lab, or not valid now.
    #[error("the certificate {name}: {source}; expected a valid one of this lab")]
    Chain {
        /// Its name.
        name: CertificateName,
        /// What the library said.
        source: webpki::Error,
    },
    /// Whoever shows it does not have its key.
    #[error("the signature is not by the key of the certificate {0}")]
    Signature(CertificateName),
}

/// A certificate with its key, and what is needed to judge those of others.
pub struct Credentials {
    authority: CertificateDer<'static>,
    certificate: Vec<u8>,
    key: KeyPair,
    withdrawn: BTreeSet<CertificateName>,
}

impl Credentials {
    /// Those of the folder of a program's certificate.
    ///
    /// # Errors
    /// When a file cannot be read or holds something else.
    pub fn read(folder: &Path) -> Result<Self, CredentialsError> {
        let path = folder.join("key.pem");
        let key = String::from_utf8(read(&path)?).ok();
        let key = key.and_then(|key| KeyPair::from_pem(&key).ok());
        let key = key.ok_or(CredentialsError::Malformed { path })?;
        Ok(Self {
            authority: certificate(&folder.join("ca.pem"))?.into(),
            certificate: certificate(&folder.join("cert.pem"))?,
            key,
            withdrawn: withdrawn::beside(folder)?,
        })
    }

    /// The proof of `datagram`.
    ///
    /// # Errors
    /// When the key does not sign.
    pub fn prove(&self, datagram: &Datagram) -> Result<Proof, CredentialsError> {
        Ok(Proof {
            certificate: self.certificate.clone(),
            signature: self.key.sign(&datagram.signed())?,
        })
    }

    /// Whose `datagram` is, if its `proof` is sound and gives one of `rights`. What costs little is checked first.
    ///
    /// # Errors
    /// Why it is not believed.
    pub fn check(
        &self,
        datagram: &Datagram,
        proof: Option<&Proof>,
        rights: &[Right],
    ) -> Result<CertificateName, Denial> {
        let proof = proof.ok_or(Denial::Missing)?;
        let (_, shown) =
            X509Certificate::from_der(&proof.certificate).map_err(|_| Denial::Malformed)?;
        let name: CertificateName = name(&shown).ok_or(Denial::Malformed)?.parse()?;
        if !rights.contains(&name.right) {
            return Err(Denial::Right(name));
        }
        if self.withdrawn.contains(&name) {
            return Err(Denial::Withdrawn(name));
        }
        let chain = |source| Denial::Chain { name, source };
        let der = CertificateDer::from(&proof.certificate[..]);
        let shown = EndEntityCert::try_from(&der).map_err(chain)?;
        let anchor = [anchor_from_trusted_cert(&self.authority).map_err(chain)?];
        let (now, usage) = (UnixTime::now(), KeyUsage::client_auth());
        let verified =
            shown.verify_for_usage(&[ECDSA_P256_SHA256], &anchor, &[], now, usage, None, None);
        verified.map_err(chain)?;
        shown
            .verify_signature(ECDSA_P256_SHA256, &datagram.signed(), &proof.signature)
            .map_err(|_| Denial::Signature(name))?;
        Ok(name)
    }
}

fn read(path: &Path) -> Result<Vec<u8>, CredentialsError> {
    fs::read(path).map_err(|source| CredentialsError::File {
        path: path.to_path_buf(),
        source,
    })
}

/// The first certificate of a file, in DER.
fn certificate(path: &Path) -> Result<Vec<u8>, CredentialsError> {
    let text = read(path)?;
    let pem = parse_x509_pem(&text).map_err(|_| CredentialsError::Malformed {
        path: path.to_path_buf(),
    })?;
    Ok(pem.1.contents)
}
