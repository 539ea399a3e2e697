//! Connection options of a program of a rig.

use feeler_console::CommandError;
use feeler_link::security::Right;
use feeler_link::transport::{HAND_ENDPOINT, ImpairedNetwork, Impairment, LinkConfig, Network};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Connection of a program to its rig.
#[derive(Debug, Clone, Default)]
pub struct LinkOptions {
    /// Endpoints of the hand, such as `tls/10.0.0.5:7447`; if empty, the default endpoint of this computer.
    pub connect: Vec<String>,
    /// Folder of this computer's certificates, or `None` without TLS.
    pub certificates: Option<PathBuf>,
    /// Simulated network impairment, or `None` to use the network as it is.
    pub impairment: Option<Impairment>,
}

/// Endpoints on which a hand listens.
#[derive(Debug, Clone, Default)]
pub struct ListenOptions {
    /// Endpoints; if empty, the default endpoint of this computer.
    pub listen: Vec<String>,
    /// `true` if other computers may connect without certificates.
    pub insecure: bool,
}

impl ListenOptions {
    /// Listens on `endpoint` only.
    pub fn at(endpoint: &str) -> Self {
        Self {
            listen: vec![endpoint.into()],
            insecure: false,
        }
    }

    /// Endpoints to listen on.
    pub fn endpoints(&self) -> Vec<String> {
        or_default(&self.listen)
    }
}

fn or_default(endpoints: &[String]) -> Vec<String> {
    match endpoints {
        [] => vec![HAND_ENDPOINT.into()],
        given => given.to_vec(),
    }
}

impl LinkOptions {
    /// Connects to the hand at `endpoint`.
    pub fn connecting_to(endpoint: &str) -> Self {
        Self {
            connect: vec![endpoint.into()],
            ..Self::default()
        }
    }

    /// Endpoints of the hand.
    pub fn endpoints(&self) -> Vec<String> {
        or_default(&self.connect)
    }

    /// Selects a certificate that grants one of `rights`, in order of preference, if certificates are used. Prints a warning
    /// on standard error if it expires soon.
    ///
    /// # Errors
    /// If no valid certificate grants any of the rights.
    pub fn with_right(&self, rights: &[Right]) -> Result<Self, CommandError> {
        let mut options = self.clone();
        if let Some(folder) = &mut options.certificates {
            *folder = Right::folder_in(folder, rights);
            check_certificate(folder, rights)?;
        }
        Ok(options)
    }

    /// Opens the network of the rig `name` for a program that connects to the hand.
    ///
    /// # Errors
    /// If an endpoint is invalid or the network cannot be opened.
    pub fn connect(&self, name: &str) -> Result<Arc<dyn Network>, CommandError> {
        self.open(LinkConfig {
            rig: name.into(),
            connect: self.endpoints(),
            ..LinkConfig::default()
        })
    }

    /// Opens the network of the rig `name` for its hand, to which the other programs connect.
    ///
    /// # Errors
    /// If an endpoint is invalid or the network cannot be opened.
    pub fn listen(
        &self,
        name: &str,
        listening: &ListenOptions,
    ) -> Result<Arc<dyn Network>, CommandError> {
        self.open(LinkConfig {
            rig: name.into(),
            is_hand: true,
            listen: listening.endpoints(),
            connect: self.connect.clone(),
            insecure: listening.insecure,
            ..LinkConfig::default()
        })
    }

    fn open(&self, config: LinkConfig) -> Result<Arc<dyn Network>, CommandError> {
        let network = open(&LinkConfig {
            certificates: self.certificates.clone(),
            ..config
        })?;
        Ok(match self.impairment {
            Some(impairment) => Arc::new(ImpairedNetwork::new(network, impairment)),
            None => network,
        })
    }
}

/// Refuses a certificate that is invalid and warns of one that expires soon.
#[cfg(feature = "link")]
fn check_certificate(folder: &Path, rights: &[Right]) -> Result<(), CommandError> {
    use std::io::Write as _;
    let own = feeler_link::security::OwnCertificate::read(folder, rights)?;
    if let Some(warning) = own.warning() {
        // A closed standard error does not invalidate the certificate.
        let _ = writeln!(std::io::stderr(), "{warning}");
    }
    Ok(())
}

#[cfg(not(feature = "link"))]
fn check_certificate(_: &Path, _: &[Right]) -> Result<(), CommandError> {
    Ok(())
}

#[cfg(feature = "link")]
fn open(config: &LinkConfig) -> Result<Arc<dyn Network>, CommandError> {
    Ok(Arc::new(feeler_link::transport::Link::open(config)?))
}

#[cfg(not(feature = "link"))]
fn open(config: &LinkConfig) -> Result<Arc<dyn Network>, CommandError> {
    config.check()?;
    Err("this program was built without the link; build it with --features link".into())
}
