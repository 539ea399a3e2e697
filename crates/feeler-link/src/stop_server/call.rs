//! Client of the stop server.

use super::proof::{Credentials, CredentialsError, Denial};
use super::wire::{Cookie, Datagram, MAX_BYTES, Nonce, StopAnswer, Verdict, parse};
use crate::messages::printable::printable;
use crate::security::right::Right;
use crate::transport::endpoints::{LinkError, address};
use ring::rand::{SecureRandom, SystemRandom};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::path::Path;
use std::time::{Duration, Instant};
use std::{io, thread};

/// Interval between repeated calls.
const INTERVAL: Duration = Duration::from_millis(100);
/// Maximum total duration of a call.
const LONGEST: Duration = Duration::from_secs(5);

/// Error of a call to the stop server: the hand did not stop, or did not confirm that it stopped.
#[derive(Debug, thiserror::Error)]
pub enum StopCallError {
    /// Invalid endpoint, or missing certificates.
    #[error(transparent)]
    Endpoint(#[from] LinkError),
    /// Invalid certificates.
    #[error("stop server: {0}")]
    Credentials(#[from] CredentialsError),
    /// The endpoint cannot be reached.
    #[error("stop server at {endpoint}: {source}; expected a reachable address")]
    Socket {
        /// The unreachable endpoint.
        endpoint: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The system provides no random numbers.
    #[error("stop server: the system provides no random numbers")]
    Random,
    /// The call does not fit into a datagram.
    #[error(
        "stop server: the call has {length} bytes with rig and certificate; expected at most {MAX_BYTES}"
    )]
    TooLong {
        /// Size of the call in bytes.
        length: usize,
    },
    /// The hand refused the order.
    #[error("the hand refuses to stop: {0}")]
    Refused(String),
    /// No trusted answer arrived.
    #[error(
        "no hand answered at its stop server within {LONGEST:?}{}",
        distrusted.as_ref().map(|d| format!("; untrusted answer: {d}")).unwrap_or_default()
    )]
    Unanswered {
        /// Reason why the last answer is not trusted, if any arrived.
        distrusted: Option<Denial>,
    },
}

/// Call to one address.
struct Call {
    socket: UdpSocket,
    credentials: Option<Credentials>,
    nonce: Nonce,
    rig: String,
    from: String,
}

/// Orders the hand of `rig` to stop, through the stop servers at all `tcp/` and `tls/` endpoints, and returns the hand's
/// answer. Repeats the call ten times per second for up to five seconds.
///
/// `id` identifies the order as in [`StopMessage`](crate::messages::message::StopMessage). `from` is the name of the sender,
/// truncated to 256 bytes. `tls/` endpoints require `certificates`, the folder of a certificate with the right to stop.
///
/// # Errors
/// If the call cannot be sent, the hand refuses, or no trusted answer arrives.
pub fn call_stop(
    endpoints: &[String],
    certificates: Option<&Path>,
    rig: &str,
    (id, from): (u64, &str),
) -> Result<StopAnswer, StopCallError> {
    let mut calls = Vec::new();
    for endpoint in endpoints {
        calls.extend(Call::new(endpoint, certificates, rig, (id, from))?);
    }
    let (start, mut distrusted) = (Instant::now(), None);
    let shares = u32::try_from(calls.len()).unwrap_or(u32::MAX).max(1);
    while start.elapsed() < LONGEST {
        for call in &calls {
            let hello = Datagram::Hello { nonce: call.nonce };
            // A failed send is retried in the next round.
            let _ = call.socket.send(&hello.bytes());
        }
        let mut waited = Instant::now();
        for call in &calls {
            waited += INTERVAL / shares;
            match call.listen(waited)? {
                Some(Ok(Verdict::Taken(answer))) => return Ok(answer),
                Some(Ok(Verdict::Refused(why))) => return Err(StopCallError::Refused(why)),
                Some(Err(denial)) => distrusted = Some(denial),
                None => {}
            }
        }
        thread::sleep(waited.saturating_duration_since(Instant::now()));
    }
    Err(StopCallError::Unanswered { distrusted })
}

impl Call {
    /// Creates a call to each address of an endpoint. Returns no calls for a `udp/` endpoint, which has no stop server.
    fn new(
        endpoint: &str,
        certificates: Option<&Path>,
        rig: &str,
        (id, from): (u64, &str),
    ) -> Result<Vec<Self>, StopCallError> {
        let (protocol, address) = address(endpoint)?;
        if protocol == "udp" {
            return Ok(Vec::new());
        }
        let failed = |source| StopCallError::Socket {
            endpoint: endpoint.into(),
            source,
        };
        let mut calls = Vec::new();
        for address in address.to_socket_addrs().map_err(failed)? {
            let credentials = match (protocol, certificates) {
                ("tls", None) => {
                    let endpoint = endpoint.into();
                    return Err(LinkError::NoCertificates { endpoint }.into());
                }
                ("tls", Some(folder)) => Some(Credentials::read(folder)?),
                _ => None,
            };
            let mut nonce = Nonce::default();
            let drawn = SystemRandom::new().fill(&mut nonce);
            drawn.map_err(|_| StopCallError::Random)?;
            nonce[..8].copy_from_slice(&id.to_le_bytes());
            calls.push(Self {
                socket: socket(address).map_err(failed)?,
                credentials,
                nonce,
                rig: rig.into(),
                from: printable(from),
            });
        }
        Ok(calls)
    }

    /// Processes challenges until a verdict or an untrusted answer arrives, or until the time `until`.
    fn listen(&self, until: Instant) -> Result<Option<Result<Verdict, Denial>>, StopCallError> {
        let mut bytes = [0; MAX_BYTES + 1];
        loop {
            let left = until.saturating_duration_since(Instant::now());
            // A zero timeout is an error.
            if left.is_zero() || self.socket.set_read_timeout(Some(left)).is_err() {
                return Ok(None);
            }
            let Ok(length) = self.socket.recv(&mut bytes) else {
                // Timeout, or the hand does not listen yet.
                return Ok(None);
            };
            match parse(&bytes[..length]) {
                Some(Datagram::Challenge { nonce, cookie }) if nonce == self.nonce => {
                    let _ = self.socket.send(&self.stop(cookie)?);
                }
                Some(answer @ Datagram::Answer { nonce, .. }) if nonce == self.nonce => {
                    return Ok(Some(self.believe(answer)));
                }
                _ => {}
            }
        }
    }

    fn stop(&self, cookie: Cookie) -> Result<Vec<u8>, StopCallError> {
        let mut call = Datagram::Stop {
            nonce: self.nonce,
            cookie,
            rig: self.rig.clone(),
            from: self.from.clone(),
            proof: None,
        };
        if let Some(credentials) = &self.credentials {
            let signed = credentials.prove(&call)?;
            if let Datagram::Stop { proof, .. } = &mut call {
                *proof = Some(signed);
            }
        }
        let bytes = call.bytes();
        match bytes.len() {
            length if length > MAX_BYTES => Err(StopCallError::TooLong { length }),
            _ => Ok(bytes),
        }
    }

    /// Checks that an answer is from a hand, and returns its verdict.
    fn believe(&self, answer: Datagram) -> Result<Verdict, Denial> {
        if let (Some(credentials), Datagram::Answer { proof, .. }) = (&self.credentials, &answer) {
            credentials.check(&answer, proof.as_ref(), &[Right::Hand])?;
        }
        match answer {
            Datagram::Answer { verdict, .. } => Ok(match verdict {
                Verdict::Refused(why) => Verdict::Refused(printable(&why)),
                Verdict::Taken(answer) => Verdict::Taken(StopAnswer {
                    stopped: printable(&answer.stopped),
                    ..answer
                }),
            }),
            _ => Err(Denial::Malformed),
        }
    }
}

/// Opens a socket that receives from `address` only.
fn socket(address: SocketAddr) -> io::Result<UdpSocket> {
    let any = match address {
        SocketAddr::V4(_) => "0.0.0.0:0",
        SocketAddr::V6(_) => "[::]:0",
    };
    let socket = UdpSocket::bind(any)?;
    socket.connect(address)?;
    Ok(socket)
}
