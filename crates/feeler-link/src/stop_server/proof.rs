//! Authentication of the stop server's datagrams by certificates and signatures.

use super::wire::{Datagram, Proof};
use crate::security::files::FileError;
use crate::security::own_certificate::name;
use crate::security::right::{CertificateName, Right, RightError};
use crate::security::withdrawn;
use crate::security::withdrawn::WithdrawnError;
use rcgen::{KeyPair, SigningKey};
use rustls_pki_types::{CertificateDer, UnixTime};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use webpki::ring::ECDSA_P256_SHA256;
use webpki::{EndEntityCert, KeyUsage, anchor_from_trusted_cert};
use x509_parser::pem::parse_x509_pem;
use x509_parser::prelude::{FromDer, X509Certificate};

/// Error of the certificates in a folder.
#[derive(Debug, thiserror::Error)]
pub enum CredentialsError {
    /// A file cannot be read.
    #[error("{0}; expected a folder created by feeler certificates")]
    File(#[from] FileError),
    /// Not a certificate or key.
    #[error("{}: expected a certificate or a key created by feeler certificates", path.display())]
    Malformed {
        /// Path of the file.
        path: PathBuf,
    },
    /// The list of revoked certificates cannot be read.
    #[error(transparent)]
    Withdrawn(#[from] WithdrawnError),
    /// Signing failed.
    #[error("cannot sign with the certificate's key: {0}")]
    Signing(#[from] rcgen::Error),
}

/// Reason for rejecting a proof.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Denial {
    /// The datagram contains no proof.
    #[error("no certificate; expected a certificate of this lab")]
    Missing,
    /// Not a certificate.
    #[error("invalid certificate; expected a certificate of this lab")]
    Malformed,
    /// The common name contains no right.
    #[error("certificate without a right: {0}")]
    Name(#[from] RightError),
    /// The certificate does not grant the required right.
    #[error("certificate {0} does not grant this right")]
    Right(CertificateName),
    /// Revoked by the lab.
    #[error("certificate {0} is withdrawn")]
    Withdrawn(CertificateName),
    /// Issued by another lab, or not valid now.
    #[error("certificate {name}: {source}; expected a valid one of this lab")]
    Chain {
        /// Name of the certificate.
        name: CertificateName,
        /// Error of the certificate library.
        source: webpki::Error,
    },
    /// The signature does not match the certificate's key.
    #[error("the signature is not by the key of certificate {0}")]
    Signature(CertificateName),
}

/// Certificate and key of a program, with the authority and the revoked names against which other certificates are
/// checked.
pub struct Credentials {
    authority: CertificateDer<'static>,
    certificate: Vec<u8>,
    key: KeyPair,
    withdrawn: BTreeSet<CertificateName>,
}

impl Credentials {
    /// Reads the credentials in the folder of a program's certificate.
    ///
    /// # Errors
    /// If a file cannot be read or is invalid.
    pub fn read(folder: &Path) -> Result<Self, CredentialsError> {
        let path = folder.join("key.pem");
        let key = String::from_utf8(fs::read(&path).map_err(FileError::at(&path))?).ok();
        let key = key.and_then(|key| KeyPair::from_pem(&key).ok());
        let key = key.ok_or(CredentialsError::Malformed { path })?;
        Ok(Self {
            authority: certificate(&folder.join("ca.pem"))?.into(),
            certificate: certificate(&folder.join("cert.pem"))?,
            key,
            withdrawn: withdrawn::beside(folder)?,
        })
    }

    /// Signs `datagram`.
    ///
    /// # Errors
    /// If signing fails.
    pub fn prove(&self, datagram: &Datagram) -> Result<Proof, CredentialsError> {
        Ok(Proof {
            certificate: self.certificate.clone(),
            signature: self.key.sign(&datagram.signed())?,
        })
    }

    /// Checks that `proof` is valid for `datagram` and grants one of `rights`, with the cheapest checks first. Returns
    /// the name of the certificate.
    ///
    /// # Errors
    /// Returns the reason if the proof is rejected.
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

/// Reads the first certificate of a PEM file, as DER.
fn certificate(path: &Path) -> Result<Vec<u8>, CredentialsError> {
    let text = fs::read(path).map_err(FileError::at(path))?;
    let pem = parse_x509_pem(&text).map_err(|_| CredentialsError::Malformed {
        path: path.to_path_buf(),
    })?;
    Ok(pem.1.contents)
}
