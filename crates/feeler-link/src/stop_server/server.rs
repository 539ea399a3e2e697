//! Stop server: a UDP server for stop orders, on the port on which the hand listens. Unlike the link, it cannot be
//! blocked by opening many connections.
//!
//! A call has two exchanges: hello and challenge, which verify the caller's address, then stop and answer. Until an
//! address is verified, the server keeps no state about the caller and never answers with more bytes than it received.
//! It checks a bounded number of signatures per second. Saturating the network still blocks it.

use super::guard::{StopGuard, StopHandler};
use super::proof::{Credentials, CredentialsError};
use super::wire::MAX_BYTES;
pub use super::wire::StopAnswer;
use crate::transport::endpoints::{LinkError, address};
use ring::rand::SystemRandom;
use ring::{error::Unspecified, hmac};
use std::io;
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Maximum time to close the server.
const CLOSING: Duration = Duration::from_millis(200);

/// Error of opening the stop server.
#[derive(Debug, thiserror::Error)]
pub enum StopServerError {
    /// Invalid endpoint, or missing certificates.
    #[error(transparent)]
    Endpoint(#[from] LinkError),
    /// Invalid certificates.
    #[error("stop server: {0}")]
    Credentials(#[from] CredentialsError),
    /// The port is in use or not available.
    #[error("stop server at {endpoint}: {source}; expected a free UDP port")]
    Socket {
        /// The unavailable endpoint.
        endpoint: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The system provides no random numbers.
    #[error("stop server: the system provides no random numbers")]
    Random,
}

/// Server for stop orders. Closes when dropped.
pub struct StopServer {
    addresses: Vec<SocketAddr>,
    closing: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl StopServer {
    /// Starts a server at each `tcp/` and `tls/` endpoint of `listen`, for the hand of `rig`. Callers at `tls/`
    /// endpoints must present a certificate, which is checked against the hand's folder `certificates`.
    ///
    /// `answering` is called with the order's id and the sender's name; it stops the hand and returns the answer. It
    /// runs on the endpoint's thread, once per call.
    ///
    /// # Errors
    /// If an endpoint or the certificates are invalid, or a UDP port is in use.
    pub fn open(
        listen: &[String],
        certificates: Option<&Path>,
        rig: &str,
        answering: impl Fn(u64, &str) -> StopAnswer + Send + Sync + 'static,
    ) -> Result<Self, StopServerError> {
        let answering: StopHandler = Arc::new(answering);
        let mut door = Self {
            addresses: Vec::new(),
            closing: Arc::default(),
            threads: Vec::new(),
        };
        for endpoint in listen {
            let (protocol, address) = address(endpoint)?;
            // The link itself uses this UDP port.
            if protocol == "udp" {
                continue;
            }
            let credentials = match (protocol, certificates) {
                ("tls", None) => {
                    let endpoint = endpoint.clone();
                    return Err(LinkError::NoCertificates { endpoint }.into());
                }
                ("tls", Some(folder)) => Some(Arc::new(Credentials::read(folder)?)),
                _ => None,
            };
            let secret = hmac::Key::generate(hmac::HMAC_SHA256, &SystemRandom::new());
            let secret = secret.map_err(|Unspecified| StopServerError::Random)?;
            let guard = StopGuard::new(secret, rig, credentials, Arc::clone(&answering));
            let opened = door.serve(address, guard);
            opened.map_err(|source| StopServerError::Socket {
                endpoint: endpoint.clone(),
                source,
            })?;
        }
        Ok(door)
    }

    /// Returns the addresses of the servers.
    pub fn addresses(&self) -> &[SocketAddr] {
        &self.addresses
    }

    fn serve(&mut self, address: &str, mut guard: StopGuard) -> io::Result<()> {
        let addresses: Vec<SocketAddr> = address.to_socket_addrs()?.collect();
        let socket = UdpSocket::bind(&addresses[..])?;
        socket.set_read_timeout(Some(CLOSING))?;
        self.addresses.push(socket.local_addr()?);
        let (closing, start) = (Arc::clone(&self.closing), Instant::now());
        let work = move || {
            // One byte more than the maximum, to detect datagrams that are too long.
            let mut bytes = [0; MAX_BYTES + 1];
            while !closing.load(Ordering::Relaxed) {
                // Errors are timeouts, or belong to earlier answers.
                let Ok((length, caller)) = socket.recv_from(&mut bytes) else {
                    continue;
                };
                if let Some(answer) = guard.answer(caller, &bytes[..length], start.elapsed()) {
                    // A caller that misses the answer repeats its call.
                    let _ = socket.send_to(&answer, caller);
                }
            }
        };
        let thread = thread::Builder::new()
            .name("stop server".into())
            .spawn(work)?;
        self.threads.push(thread);
        Ok(())
    }
}

impl Drop for StopServer {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A panic has already closed the socket.
            let _ = thread.join();
        }
    }
}
