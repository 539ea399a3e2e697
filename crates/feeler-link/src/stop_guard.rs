//! What the stop door answers to a datagram. It keeps nothing of a caller whose address is not proven, and checks no more
//! signatures than a core has time for.

use super::printable::printable;
use super::right::Right;
use super::stop_proof::{Credentials, Denial};
use super::stop_wire::{Cookie, Datagram, MOST_BYTES, Nonce, StopAnswer, Verdict, id_of, parse};
use ring::hmac;
use std::collections::{HashMap, VecDeque};
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

/// Who may stop the hand.
const MAY_STOP: [Right; 3] = [Right::Order, Right::Stop, Right::Hand];

/// A challenge is good for this long, and for as long again.
const CHALLENGE: Duration = Duration::from_secs(10);

/// Calls whose signatures are checked in a second, of all callers and of each address. A check and the signature of its
/// answer take a fraction of a millisecond.
const CHECKS: u32 = 200;
const CHECKS_OF_ONE: u32 = 20;

/// Answers kept for callers that did not hear them.
const KEPT: usize = 64;

/// What the hand says to a stop, given the order's id and who says so.
pub type Answering = Arc<dyn Fn(u64, &str) -> StopAnswer + Send + Sync>;

/// Judges what arrives at one socket.
pub struct Guard {
    secret: hmac::Key,
    rig: String,
    credentials: Option<Arc<Credentials>>,
    answering: Answering,
    budget: Budget,
    kept: VecDeque<Kept>,
}

/// An answer that was given.
struct Kept {
    to: SocketAddr,
    nonce: Nonce,
    at: Duration,
    bytes: Vec<u8>,
}

impl Guard {
    /// The guard of the hand of `rig`, with a secret of its own; without `credentials` anybody may stop the hand.
    pub fn new(
        secret: hmac::Key,
        rig: &str,
        credentials: Option<Arc<Credentials>>,
        answering: Answering,
    ) -> Self {
        Self {
            secret,
            rig: rig.into(),
            credentials,
            answering,
            budget: Budget::default(),
            kept: VecDeque::new(),
        }
    }

    /// The answer to what arrived from `caller` at the time `now` since the door was opened; mostly none.
    pub fn answer(&mut self, caller: SocketAddr, bytes: &[u8], now: Duration) -> Option<Vec<u8>> {
        let datagram = parse(bytes)?;
        match &datagram {
            Datagram::Hello { nonce } => {
                let (nonce, cookie) = (*nonce, self.cookie(caller, nonce, slot(now)));
                Some(Datagram::Challenge { nonce, cookie }.bytes())
            }
            Datagram::Stop { nonce, cookie, .. } => {
                self.is_ours(caller, nonce, cookie, now).then_some(())?;
                self.given(caller, nonce, now)
                    .or_else(|| self.judge(caller, &datagram, now))
            }
            _ => None,
        }
    }

    /// Whether this is the challenge that the caller was sent, not long ago.
    fn is_ours(&self, caller: SocketAddr, nonce: &Nonce, cookie: &Cookie, now: Duration) -> bool {
        let slots = [Some(slot(now)), slot(now).checked_sub(1)];
        let mut slots = slots.into_iter().flatten();
        slots.any(|slot| {
            let input = cookie_input(caller, nonce, slot);
            hmac::verify(&self.secret, &input, cookie).is_ok()
        })
    }

    fn cookie(&self, caller: SocketAddr, nonce: &Nonce, slot: u64) -> Cookie {
        let tag = hmac::sign(&self.secret, &cookie_input(caller, nonce, slot));
        let mut cookie = Cookie::default();
        cookie.copy_from_slice(tag.as_ref());
        cookie
    }

    /// The answer that this call has had: it is one order, however often it is said.
    fn given(&mut self, caller: SocketAddr, nonce: &Nonce, now: Duration) -> Option<Vec<u8>> {
        self.kept.retain(|kept| now < kept.at + 2 * CHALLENGE);
        let same = |kept: &&Kept| kept.to == caller && kept.nonce == *nonce;
        Some(self.kept.iter().find(same)?.bytes.clone())
    }

    /// Judges a call from an address that is proven.
    fn judge(&mut self, caller: SocketAddr, call: &Datagram, now: Duration) -> Option<Vec<u8>> {
        let Datagram::Stop {
            nonce,
            rig,
            from,
            proof,
            ..
        } = call
        else {
            return None;
        };
        if !self.budget.allows(caller.ip(), now) {
            return None;
        }
        let may = match &self.credentials {
            Some(credentials) => credentials
                .check(call, proof.as_ref(), &MAY_STOP)
                .map(|_| ()),
            None => Ok::<(), Denial>(()),
        };
        let verdict = match may {
            Err(denial) => Verdict::Refused(printable(&denial.to_string())),
            Ok(()) if *rig != self.rig => {
                let why = format!("this is the hand of rig {:?}, not of {rig:?}", self.rig);
                Verdict::Refused(printable(&why))
            }
            Ok(()) => {
                let answer = (self.answering)(id_of(nonce), &printable(from));
                let (order, stopped) = (answer.order, printable(&answer.stopped));
                Verdict::Taken(StopAnswer { order, stopped })
            }
        };
        let is_taken = matches!(verdict, Verdict::Taken(_));
        let bytes = self.proven(*nonce, verdict)?;
        if is_taken {
            self.keep(caller, *nonce, now, &bytes);
        }
        Some(bytes)
    }

    fn proven(&self, nonce: Nonce, verdict: Verdict) -> Option<Vec<u8>> {
        let mut answer = Datagram::Answer {
            nonce,
            verdict,
            proof: None,
        };
        if let Some(credentials) = &self.credentials {
            let signed = credentials.prove(&answer).ok()?;
            if let Datagram::Answer { proof, .. } = &mut answer {
                *proof = Some(signed);
            }
        }
        let bytes = answer.bytes();
        (bytes.len() <= MOST_BYTES).then_some(bytes)
    }

    fn keep(&mut self, to: SocketAddr, nonce: Nonce, at: Duration, bytes: &[u8]) {
        if self.kept.len() == KEPT {
            self.kept.pop_front();
        }
        let bytes = bytes.to_vec();
        self.kept.push_back(Kept {
            to,
            nonce,
            at,
            bytes,
        });
    }
}

fn slot(now: Duration) -> u64 {
    now.as_secs() / CHALLENGE.as_secs()
}

fn cookie_input(caller: SocketAddr, nonce: &Nonce, slot: u64) -> Vec<u8> {
    let ip = match caller.ip() {
        IpAddr::V4(ip) => ip.to_ipv6_mapped(),
        IpAddr::V6(ip) => ip,
    };
    let port = caller.port().to_le_bytes();
    [&ip.octets()[..], &port, nonce, &slot.to_le_bytes()].concat()
}

/// How many calls may be judged.
#[derive(Default)]
struct Budget {
    second: u64,
    judged: u32,
    by_address: HashMap<IpAddr, u32>,
}

impl Budget {
    fn allows(&mut self, caller: IpAddr, now: Duration) -> bool {
        if now.as_secs() != self.second {
            *self = Self {
                second: now.as_secs(),
                ..Self::default()
            };
        }
        let of_one = self.by_address.get(&caller).copied().unwrap_or(0);
        if self.judged >= CHECKS || of_one >= CHECKS_OF_ONE {
            return false;
        }
        self.judged += 1;
        self.by_address.insert(caller, of_one + 1);
        true
    }
}
