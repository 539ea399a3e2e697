//! A way to stop the hand that nobody can block by opening connections: datagrams, on the port at which the hand listens.
//!
//! A call is two exchanges: hello and challenge, which prove the caller's address, then stop and answer. The door keeps
//! nothing of whoever has not answered a challenge, answers nothing longer than what it was asked before that, and
//! checks a bounded number of signatures a second. Who can put more datagrams onto the wire than it carries still
//! keeps everybody out.

use super::endpoints::{LinkError, address};
use super::stop_guard::{Answering, Guard};
use super::stop_proof::{Credentials, CredentialsError};
use super::stop_wire::MOST_BYTES;
pub use super::stop_wire::StopAnswer;
use ring::rand::SystemRandom;
use ring::{error::Unspecified, hmac};
use std::io;
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// How long closing the door may take.
const CLOSING: Duration = Duration::from_millis(200);

/// Why the door does not open.
#[derive(Debug, thiserror::Error)]
pub enum StopDoorError {
    /// An endpoint that is none, or that has no certificates.
    #[error(transparent)]
    Endpoint(#[from] LinkError),
    /// The certificates are of no use.
    #[error("the stop door: {0}")]
    Credentials(#[from] CredentialsError),
    /// The place is taken, or cannot be had.
    #[error("the stop door at {endpoint}: {source}; expected a UDP port that nobody has")]
    Socket {
        /// The endpoint.
        endpoint: String,
        /// What the system said.
        source: io::Error,
    },
    /// The system gives no random numbers.
    #[error("the stop door: expected random numbers of the system, and got none")]
    Random,
}

/// The door, open until it is dropped.
pub struct StopDoor {
    addresses: Vec<SocketAddr>,
    closing: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl StopDoor {
    /// Opens it at each endpoint of `listen` with tcp/ or tls/, for the hand of `rig`. At those with tls/ a caller shows a
    /// certificate, by those in the hand's folder `certificates`. `answering` is told the order's id and who says stop, and says what
    /// the hand is about; it is called by the thread of an endpoint, and not again for the same call.
    ///
    /// # Errors
    /// When an endpoint or the certificates are of no use, or a UDP port is taken.
    pub fn open(
        listen: &[String],
        certificates: Option<&Path>,
        rig: &str,
        answering: impl Fn(u64, &str) -> StopAnswer + Send + Sync + 'static,
    ) -> Result<Self, StopDoorError> {
        let answering: Answering = Arc::new(answering);
        let mut door = Self {
            addresses: Vec::new(),
            closing: Arc::default(),
            threads: Vec::new(),
        };
        for endpoint in listen {
            let (protocol, address) = address(endpoint)?;
            // Its UDP port is the link's own.
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
            let secret = secret.map_err(|Unspecified| StopDoorError::Random)?;
            let guard = Guard::new(secret, rig, credentials, Arc::clone(&answering));
            let opened = door.serve(address, guard);
            opened.map_err(|source| StopDoorError::Socket {
                endpoint: endpoint.clone(),
                source,
            })?;
        }
        Ok(door)
    }

    /// Where it is open.
    pub fn addresses(&self) -> &[SocketAddr] {
        &self.addresses
    }

    fn serve(&mut self, address: &str, mut guard: Guard) -> io::Result<()> {
        let addresses: Vec<SocketAddr> = address.to_socket_addrs()?.collect();
        let socket = UdpSocket::bind(&addresses[..])?;
        socket.set_read_timeout(Some(CLOSING))?;
        self.addresses.push(socket.local_addr()?);
        let (closing, start) = (Arc::clone(&self.closing), Instant::now());
        let work = move || {
            // One byte more than any datagram has: what is longer is not taken for one that is cut off.
            let mut bytes = [0; MOST_BYTES + 1];
            while !closing.load(Ordering::Relaxed) {
                // Errors are those of earlier answers, or that nothing came.
                let Ok((length, caller)) = socket.recv_from(&mut bytes) else {
                    continue;
                };
                if let Some(answer) = guard.answer(caller, &bytes[..length], start.elapsed()) {
                    // A caller that does not hear it asks again.
                    let _ = socket.send_to(&answer, caller);
                }
            }
        };
        let thread = thread::Builder::new()
            .name("stop door".into())
            .spawn(work)?;
        self.threads.push(thread);
        Ok(())
    }
}

impl Drop for StopDoor {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // One that panicked has closed its socket.
            let _ = thread.join();
        }
    }
}
