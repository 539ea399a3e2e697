//! Where a program listens and whom it connects to, and what keeps others out.

use super::withdrawn::WithdrawnError;
use std::path::PathBuf;

/// Where the hand listens unless told otherwise: nobody on another computer can come in.
pub const HAND_ENDPOINT: &str = "tcp/127.0.0.1:7447";

/// How a program takes part in the link.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinkConfig {
    /// Name of the rig: programs of another rig are not heard.
    pub rig: String,
    /// Whether this is the hand, which listens and passes on the messages of all others.
    pub is_hand: bool,
    /// Where the hand listens, as in `tls/0.0.0.0:7447`.
    pub listen: Vec<String>,
    /// Where the hand is, again and again until it is there; of several endpoints, the first that answers.
    pub connect: Vec<String>,
    /// Folder of the lab's certificates, for endpoints with TLS: `ca.pem`, `cert.pem`, `key.pem`.
    pub certificates: Option<PathBuf>,
    /// Whether to listen beyond this computer without certificates.
    pub insecure: bool,
}

/// Why a program cannot take part in the link.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// An endpoint that is none.
    #[error(
        "endpoint {endpoint:?}: expected PROTOCOL/HOST:PORT with tcp, udp or tls, as in tcp/127.0.0.1:7447"
    )]
    Endpoint {
        /// What was given.
        endpoint: String,
    },
    /// Whoever can reach this computer could read forces and move the hand.
    #[error(
        "--listen {endpoint}: anybody on the network could move the hand; expected a tls/ endpoint with \
         --certificates (see feeler certificates), or --insecure"
    )]
    Open {
        /// The endpoint.
        endpoint: String,
    },
    /// TLS needs certificates.
    #[error(
        "endpoint {endpoint}: expected --certificates DIR beside it (feeler certificates makes them)"
    )]
    NoCertificates {
        /// The endpoint.
        endpoint: String,
    },
    /// A certificate's file is not there.
    #[error("--certificates: {} is not there; expected a folder that feeler certificates made", path.display())]
    Certificate {
        /// The file.
        path: PathBuf,
    },
    /// The name of a rig that no key can hold.
    #[error("--rig {rig:?}: expected letters, digits, - and _")]
    Rig {
        /// What was given.
        rig: String,
    },
    /// The list of withdrawn certificates cannot be read.
    #[error(transparent)]
    Withdrawn(#[from] WithdrawnError),
    /// The transport says no.
    #[error("the link: {0}")]
    Transport(String),
}

impl LinkConfig {
    /// Checks names, endpoints and that nobody uninvited can come in.
    ///
    /// # Errors
    /// The first thing that is wrong.
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

    /// The lab's certificate, this program's certificate, and its key.
    pub fn certificate_files(&self) -> Option<[PathBuf; 3]> {
        let folder = self.certificates.as_ref()?;
        Some(["ca.pem", "cert.pem", "key.pem"].map(|name| folder.join(name)))
    }
}

/// Protocol and host of an endpoint.
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

/// Protocol and address (`HOST:PORT`) of an endpoint.
#[cfg(feature = "zenoh")]
pub(super) fn address(endpoint: &str) -> Result<(&str, &str), LinkError> {
    let (protocol, _) = parts(endpoint)?;
    Ok((protocol, &endpoint[protocol.len() + 1..]))
}

/// Whether only this computer reaches `host`. A name other than `localhost` may be anybody's.
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
    fn only_this_computer_comes_in_without_certificates() {
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
    fn what_is_no_endpoint_is_said() {
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
