//! Request handler of the stop server. Stateless until the caller's address is verified, with a bounded number of
//! signature checks per second.

use super::proof::{Credentials, Denial};
use super::wire::{Cookie, Datagram, MAX_BYTES, Nonce, StopAnswer, Verdict, id_of, parse};
use crate::messages::printable::printable;
use crate::security::right::Right;
use ring::hmac;
use std::collections::{HashMap, VecDeque};
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

/// Rights that permit stopping the hand.
const MAY_STOP: [Right; 3] = [Right::Order, Right::Stop, Right::Hand];

/// Length of a time slot. A challenge is valid in its time slot and in the next one.
const CHALLENGE: Duration = Duration::from_secs(10);

/// Maximum number of signature checks per second in total. A check and the signature of the answer take a fraction of a
/// millisecond.
const CHECKS: u32 = 200;
/// Maximum number of signature checks per second for one address.
const CHECKS_OF_ONE: u32 = 20;

/// Number of answers kept, to resend them to callers that missed them.
const KEPT: usize = 64;

/// Stops the hand, given the order's id and the sender's name, and returns the answer.
pub type StopHandler = Arc<dyn Fn(u64, &str) -> StopAnswer + Send + Sync>;

/// Verifies and answers the stop requests that arrive at one UDP socket.
pub struct StopGuard {
    secret: hmac::Key,
    rig: String,
    credentials: Option<Arc<Credentials>>,
    answering: StopHandler,
    budget: Budget,
    kept: VecDeque<Kept>,
}

/// Answer that was sent.
struct Kept {
    to: SocketAddr,
    nonce: Nonce,
    at: Duration,
    bytes: Vec<u8>,
}

impl StopGuard {
    /// Creates the handler for the hand of `rig`, with a separate secret per socket. Without `credentials`, any caller
    /// may stop the hand.
    pub fn new(
        secret: hmac::Key,
        rig: &str,
        credentials: Option<Arc<Credentials>>,
        answering: StopHandler,
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

    /// Returns the answer to a datagram from `caller`, if any. `now` is the time since the server started.
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

    /// Returns `true` if `cookie` was sent to this caller in a recent challenge.
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

    /// Returns the previous answer to this call, if any, because a repeated call is a single order.
    fn given(&mut self, caller: SocketAddr, nonce: &Nonce, now: Duration) -> Option<Vec<u8>> {
        self.kept.retain(|kept| now < kept.at + 2 * CHALLENGE);
        let same = |kept: &&Kept| kept.to == caller && kept.nonce == *nonce;
        Some(self.kept.iter().find(same)?.bytes.clone())
    }

    /// Checks and executes a call from a verified address.
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
                let why = format!("expected rig {:?}, got {rig:?}", self.rig);
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
        (bytes.len() <= MAX_BYTES).then_some(bytes)
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

/// Rate limit of signature checks.
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
