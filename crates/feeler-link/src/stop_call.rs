//! Calls at a hand's stop door.

use super::endpoints::{LinkError, address};
use super::printable::printable;
use super::right::Right;
use super::stop_proof::{Credentials, CredentialsError, Denial};
use super::stop_wire::{Cookie, Datagram, MOST_BYTES, Nonce, StopAnswer, Verdict, parse};
use ring::rand::{SecureRandom, SystemRandom};
use std::io;
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

/// How often a call is repeated, and how long.
const INTERVAL: Duration = Duration::from_millis(100);
const LONGEST: Duration = Duration::from_secs(5);

/// Why a hand was not stopped, or is not known to be.
#[derive(Debug, thiserror::Error)]
pub enum StopCallError {
    /// An endpoint that is none, or that needs certificates.
    #[error(transparent)]
    Endpoint(#[from] LinkError),
    /// The certificates are of no use.
    #[error("the stop door: {0}")]
    Credentials(#[from] CredentialsError),
    /// No call can be sent there.
    #[error("the stop door at {endpoint}: {source}; expected an address that can be reached")]
    Socket {
        /// The endpoint.
        endpoint: String,
        /// What the system said.
        source: io::Error,
    },
    /// The system gives no random numbers.
    #[error("the stop door: expected random numbers of the system, and got none")]
    Random,
    /// The call does not fit.
    #[error(
        "the stop door: a call of {length} bytes, with rig and certificate; expected {MOST_BYTES} at most"
    )]
    TooLong {
        /// Its length.
        length: usize,
    },
    /// The hand says no.
    #[error("the hand refuses to stop: {0}")]
    Refused(String),
    /// Nobody says anything that can be believed.
    #[error(
        "no hand answered at its stop door within {LONGEST:?}{}",
        distrusted.as_ref().map(|d| format!("; somebody did, with {d}")).unwrap_or_default()
    )]
    Unanswered {
        /// Why an answer was not believed, if there was one.
        distrusted: Option<Denial>,
    },
}

/// A call to one endpoint.
struct Call {
    socket: UdpSocket,
    credentials: Option<Credentials>,
    nonce: Nonce,
    rig: String,
    from: String,
}

/// Tells the hand of `rig` to stop, at the stop doors of the `endpoints` with tcp/ or tls/; what it is about then. Repeats
/// itself ten times a second until it is answered, for five seconds. `id` is that of the order, as in a
/// [`StopMessage`](super::message::StopMessage); `from` is who says so: it is cut to 256 bytes.
/// For endpoints with tls/, `certificates` is the folder of a certificate with the right to stop.
///
/// # Errors
/// When it cannot be said, or nobody who can be believed answers.
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
            // What cannot be sent now can be sent later.
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
    /// Calls to all addresses of an endpoint; none where it has no stop door.
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

    /// Answers challenges until a verdict comes, or why it is not believed, or until the time `until`.
    fn listen(&self, until: Instant) -> Result<Option<Result<Verdict, Denial>>, StopCallError> {
        let mut bytes = [0; MOST_BYTES + 1];
        loop {
            let left = until.saturating_duration_since(Instant::now());
            // A timeout of nothing would be none.
            if left.is_zero() || self.socket.set_read_timeout(Some(left)).is_err() {
                return Ok(None);
            }
            let Ok(length) = self.socket.recv(&mut bytes) else {
                // Nothing came in time, or nobody is there yet.
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
            length if length > MOST_BYTES => Err(StopCallError::TooLong { length }),
            _ => Ok(bytes),
        }
    }

    /// What an answer says, if a hand says it.
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

/// A socket that hears of `address` alone.
fn socket(address: SocketAddr) -> io::Result<UdpSocket> {
    let any = match address {
        SocketAddr::V4(_) => "0.0.0.0:0",
        SocketAddr::V6(_) => "[::]:0",
    };
    let socket = UdpSocket::bind(any)?;
    socket.connect(address)?;
    Ok(socket)
}
