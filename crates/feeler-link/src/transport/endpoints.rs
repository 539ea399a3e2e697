//! Endpoints to listen on and connect to, and their access checks.

use crate::security::withdrawn::WithdrawnError;
use std::path::PathBuf;

/// Default endpoint of the hand, reachable from this computer only.
pub const HAND_ENDPOINT: &str = "tcp/127.0.0.1:7447";

/// Configuration of a program's connection to the link.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinkConfig {
    /// Name of the rig. Messages of other rigs are not received.
    pub rig: String,
    /// `true` for the hand, which listens and forwards the messages of the other programs.
    pub is_hand: bool,
    /// Endpoints on which the hand listens, e.g. `tls/0.0.0.0:7447`.
    pub listen: Vec<String>,
    /// Endpoints of the hand. They are tried repeatedly until one of them answers.
    pub connect: Vec<String>,
    /// Folder with `ca.pem`, `cert.pem` and `key.pem`, for TLS endpoints.
    pub certificates: Option<PathBuf>,
    /// `true` to allow listening on a network interface without certificates.
    pub insecure: bool,
}

/// Error of opening or using the link.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// Invalid endpoint.
    #[error(
        "endpoint {endpoint:?}: expected PROTOCOL/HOST:PORT with tcp, udp or tls, as in tcp/127.0.0.1:7447"
    )]
    Endpoint {
        /// The invalid text.
        endpoint: String,
    },
    /// A public endpoint without certificates: any computer that can reach it could read forces and move the hand.
    #[error(
        "--listen {endpoint}: anyone on the network could move the hand; use a tls/ endpoint with \
         --certificates (see feeler certificates), or --insecure"
    )]
    Open {
        /// The endpoint.
        endpoint: String,
    },
    /// TLS endpoint without certificates.
    #[error(
        "endpoint {endpoint}: TLS requires --certificates DIR (created by feeler certificates)"
    )]
    NoCertificates {
        /// The endpoint.
        endpoint: String,
    },
    /// Missing certificate file.
    #[error("--certificates: {} not found; expected a folder created by feeler certificates", path.display())]
    Certificate {
        /// Path of the file.
        path: PathBuf,
    },
    /// Rig name with characters that are not allowed in a key.
    #[error("--rig {rig:?}: expected letters, digits, - and _")]
    Rig {
        /// The invalid name.
        rig: String,
    },
    /// The list of revoked certificates cannot be read.
    #[error(transparent)]
    Withdrawn(#[from] WithdrawnError),
    /// Error of the transport.
    #[error("link error: {0}")]
    Transport(String),
}

impl LinkConfig {
    /// Checks the rig's name, the endpoints, and that public endpoints require certificates.
    ///
    /// # Errors
    /// Returns the first error found.
    pub fn check(&self) -> Result<(), LinkError> {
        let sound = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.rig.is_empty() || !self.rig.chars().all(sound) {
            let rig = self.rig.clone();
            return Err(LinkError::Rig { rig });
        }
        for endpoint in self.listen.iter().chain(&self.connect) {
            let (protocol, _) = parts(endpoint)?;
            if protocol == "tls" && self.certificates.is_none() {
                let endpoint = endpoint.clone();
                return Err(LinkError::NoCertificates { endpoint });
            }
        }
        for endpoint in &self.listen {
            let (protocol, host) = parts(endpoint)?;
            if protocol != "tls" && !is_loopback(host) && !self.insecure {
                let endpoint = endpoint.clone();
                return Err(LinkError::Open { endpoint });
            }
        }
        match self.certificate_files() {
            Some(files) => match files.into_iter().find(|path| !path.is_file()) {
                Some(path) => Err(LinkError::Certificate { path }),
                None => Ok(()),
            },
            None => Ok(()),
        }
    }

    /// Returns the paths of the lab's certificate, this program's certificate and its key.
    pub fn certificate_files(&self) -> Option<[PathBuf; 3]> {
        let folder = self.certificates.as_ref()?;
        Some(["ca.pem", "cert.pem", "key.pem"].map(|name| folder.join(name)))
    }
}

/// Returns protocol and host of an endpoint.
fn parts(endpoint: &str) -> Result<(&str, &str), LinkError> {
    let wrong = || LinkError::Endpoint {
        endpoint: endpoint.to_string(),
    };
    let (protocol, address) = endpoint.split_once('/').ok_or_else(wrong)?;
    let (host, port) = address.rsplit_once(':').ok_or_else(wrong)?;
    let known = ["tcp", "udp", "tls"].contains(&protocol);
    let sound = known && !host.is_empty() && port.parse::<u16>().is_ok();
    sound.then_some((protocol, host)).ok_or_else(wrong)
}

/// Returns protocol and address (`HOST:PORT`) of an endpoint.
#[cfg(feature = "zenoh")]
pub(crate) fn address(endpoint: &str) -> Result<(&str, &str), LinkError> {
    let (protocol, _) = parts(endpoint)?;
    Ok((protocol, &endpoint[protocol.len() + 1..]))
}

/// Returns `true` if `host` is a loopback address or `localhost`. Other names are not resolved.
fn is_loopback(host: &str) -> bool {
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    let address = bare.parse::<std::net::IpAddr>();
    bare == "localhost" || address.is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listening(endpoint: &str) -> LinkConfig {
        LinkConfig {
            rig: "bench-1".into(),
            listen: vec![endpoint.into()],
            ..LinkConfig::default()
        }
    }

    #[test]
    fn public_endpoints_require_certificates() {
        for endpoint in [
            HAND_ENDPOINT,
            "tcp/127.0.0.1:0",
            "udp/[::1]:7447",
            "tcp/localhost:0",
        ] {
            assert!(listening(endpoint).check().is_ok(), "{endpoint}");
        }
        for endpoint in [
            "tcp/0.0.0.0:7447",
            "udp/10.0.0.1:1",
            "tcp/[::]:0",
            "tcp/lab:7447",
        ] {
            let refused = listening(endpoint).check();
            assert!(matches!(refused, Err(LinkError::Open { .. })), "{endpoint}");
            let mut config = listening(endpoint);
            config.insecure = true;
            assert!(config.check().is_ok(), "{endpoint}");
        }
        let refused = listening("tls/0.0.0.0:7447").check();
        assert!(matches!(refused, Err(LinkError::NoCertificates { .. })));
    }

    #[test]
    fn invalid_endpoints_are_rejected() {
        for endpoint in [
            "",
            "tcp",
            "tcp/",
            "tcp/a",
            "tcp/a:b",
            "tcp/:1",
            "http/a:1",
            "tcp/a:70000",
        ] {
            let refused = listening(endpoint).check();
            assert!(
                matches!(refused, Err(LinkError::Endpoint { .. })),
                "{endpoint}"
            );
        }
        let mut config = listening(HAND_ENDPOINT);
        config.rig = "a/**".into();
        assert!(matches!(config.check(), Err(LinkError::Rig { .. })));
    }
}
