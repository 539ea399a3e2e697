//! Which programs there are, and which of them are taken for what.

use super::message::{Heartbeat, NO_FINGER, PROTOCOL};
use super::rejection::Rejection;
use crate::wire::cdr;

/// A program whose last heartbeat is older than this has gone, s.
pub const SILENT_AFTER: f64 = 1.0;

/// Programs that are remembered at most; a guard against a flood.
const MOST_PEERS: usize = 64;

/// What a program must agree in with this one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expected {
    /// SHA-256 of the experiment.
    pub experiment: String,
    /// SHA-256 of each finger's fingertip.
    pub fingertips: Vec<String>,
}

/// In what a program does not agree with this one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Mismatch {
    /// It speaks another version of the messages.
    #[error(
        "{program} (feeler {version}) speaks version {theirs} of the messages, this feeler {} version {PROTOCOL}",
        env!("CARGO_PKG_VERSION")
    )]
    Protocol {
        /// What the program is.
        program: String,
        /// Version of feeler that it is.
        version: String,
        /// Version of its messages.
        theirs: u32,
    },
    /// It works by another experiment.
    #[error(
        "{program} works by experiment {theirs}, this by {ours}: start both with the same file and settings"
    )]
    Experiment {
        /// What the program is.
        program: String,
        /// The beginning of the SHA-256 of its experiment.
        theirs: String,
        /// That of this program's.
        ours: String,
    },
    /// It senses by another fingertip.
    #[error(
        "{program} senses by fingertip {theirs}, the experiment's is {ours}: its layout is another"
    )]
    Fingertip {
        /// What the program is.
        program: String,
        /// The beginning of the SHA-256 of its fingertip.
        theirs: String,
        /// That of the experiment's.
        ours: String,
    },
    /// There is one like it already.
    #[error("there is {program} already")]
    Taken {
        /// What there is.
        program: String,
    },
}

impl Mismatch {
    /// Whether it stays, whatever other programs do.
    pub fn is_final(&self) -> bool {
        !matches!(self, Self::Taken { .. })
    }
}

/// Another program.
#[derive(Debug, Clone, PartialEq)]
pub struct Peer {
    /// Its newest heartbeat.
    pub heartbeat: Heartbeat,
    /// When that came, s on this program's clock.
    pub heard: f64,
    /// Why it is refused, if it is.
    pub refused: Option<Mismatch>,
}

impl Peer {
    /// What it is, in words.
    pub fn name(&self) -> String {
        name(&self.heartbeat)
    }

    /// Whether it is part of a rig, and not there only to give an order.
    pub fn works(&self) -> bool {
        works(&self.heartbeat)
    }

    /// Whether it has gone by `now`, s.
    pub fn is_silent(&self, now: f64) -> bool {
        now - self.heard > SILENT_AFTER
    }
}

/// The other programs, as their heartbeats tell.
#[derive(Debug, Clone, Default)]
pub struct Peers {
    expected: Expected,
    peers: Vec<Peer>,
}

impl Peers {
    /// No programs yet; those to come must agree with `expected`.
    pub fn new(expected: Expected) -> Self {
        Self {
            expected,
            peers: Vec::new(),
        }
    }

    /// All of them, gone or not.
    pub fn all(&self) -> &[Peer] {
        &self.peers
    }

    /// The programs of a kind that are there and taken.
    pub fn taken(&self, program: &str, now: f64) -> impl Iterator<Item = &Peer> {
        self.peers.iter().filter(move |peer| {
            peer.refused.is_none() && peer.heartbeat.program == program && !peer.is_silent(now)
        })
    }

    /// Lets pass messages of `instance` that are those of a `program`, of `finger` where it has one.
    ///
    /// # Errors
    /// When it is not known yet, is another program, or was refused.
    pub fn check(&self, instance: u64, program: &str, finger: u32) -> Result<(), Rejection> {
        let known = |peer: &&Peer| peer.heartbeat.instance == instance;
        let peer = self.peers.iter().find(known);
        let heartbeat = &peer.ok_or(Rejection::Unintroduced)?.heartbeat;
        let as_expected = heartbeat.program == program && heartbeat.finger == finger;
        let taken = as_expected && peer.is_some_and(|peer| peer.refused.is_none());
        taken.then_some(()).ok_or(Rejection::Stranger)
    }

    /// Takes in a heartbeat that came at `now`, s; the peer, if it was not known before.
    ///
    /// # Errors
    /// When it is none, or there are too many programs.
    pub fn heard(&mut self, bytes: &[u8], now: f64) -> Result<Option<&Peer>, Rejection> {
        let heartbeat = read(bytes)?;
        let known = |peer: &Peer| peer.heartbeat.instance == heartbeat.instance;
        if let Some(peer) = self.peers.iter_mut().find(|peer| known(peer)) {
            if heartbeat.sequence <= peer.heartbeat.sequence {
                return Err(Rejection::Old);
            }
            // What it is does not change, whatever the bytes say.
            if name(&heartbeat) != name(&peer.heartbeat) {
                return Err(Rejection::Stranger);
            }
            (peer.heartbeat, peer.heard) = (heartbeat, now);
            self.judge_again(now);
            return Ok(None);
        }
        // Who only gave an order is not waited for.
        self.peers
            .retain(|peer| !peer.is_silent(now) || (peer.refused.is_none() && peer.works()));
        if self.peers.len() >= MOST_PEERS {
            return Err(Rejection::Stranger);
        }
        let refused = self.mismatch(&heartbeat, now);
        self.peers.push(Peer {
            heartbeat,
            heard: now,
            refused,
        });
        self.replace_silent(self.peers.len() - 1, now);
        Ok(self.peers.last())
    }

    /// A place that was taken may have become free.
    fn judge_again(&mut self, now: f64) {
        for index in 0..self.peers.len() {
            let waits = matches!(self.peers[index].refused, Some(Mismatch::Taken { .. }));
            if waits && !self.peers[index].is_silent(now) {
                self.peers[index].refused = self.mismatch(&self.peers[index].heartbeat, now);
            }
        }
        for index in (0..self.peers.len()).rev() {
            self.replace_silent(index.min(self.peers.len() - 1), now);
        }
    }

    /// Where a program has taken the place of a silent one, that is forgotten: should it come back, it finds
    /// its place taken.
    fn replace_silent(&mut self, index: usize, now: f64) {
        let newer = &self.peers[index];
        if newer.refused.is_some() || !newer.works() || newer.is_silent(now) {
            return;
        }
        let (name, instance) = (newer.name(), newer.heartbeat.instance);
        self.peers.retain(|peer| {
            peer.heartbeat.instance == instance || !peer.is_silent(now) || peer.name() != name
        });
    }

    fn mismatch(&self, heartbeat: &Heartbeat, now: f64) -> Option<Mismatch> {
        let program = name(heartbeat);
        if heartbeat.protocol != PROTOCOL {
            return Some(Mismatch::Protocol {
                program,
                version: heartbeat.version.clone(),
                theirs: heartbeat.protocol,
            });
        }
        let works = works(heartbeat);
        let ours = &self.expected.experiment;
        if works && heartbeat.experiment != *ours {
            return Some(Mismatch::Experiment {
                program,
                theirs: short(&heartbeat.experiment),
                ours: short(ours),
            });
        }
        let finger = usize::try_from(heartbeat.finger).unwrap_or(usize::MAX);
        let ours = self.expected.fingertips.get(finger).map_or("", |f| f);
        if heartbeat.program == "sense" && heartbeat.fingertip != ours {
            return Some(Mismatch::Fingertip {
                program,
                theirs: short(&heartbeat.fingertip),
                ours: short(ours),
            });
        }
        let same = |peer: &&Peer| {
            peer.refused.is_none()
                && peer.heartbeat.instance != heartbeat.instance
                && !peer.is_silent(now)
                && peer.name() == program
        };
        let taken = works && self.peers.iter().any(|peer| same(&peer));
        taken.then_some(Mismatch::Taken { program })
    }
}

/// Reads a heartbeat; of one of another version, what stands first in all of them.
fn read(bytes: &[u8]) -> Result<Heartbeat, Rejection> {
    let field = |at: usize, length: usize| bytes.get(at..at + length);
    let protocol = field(4, 4).and_then(|b| Some(u32::from_le_bytes(b.try_into().ok()?)));
    let protocol = protocol.ok_or(Rejection::Malformed)?;
    if protocol == PROTOCOL {
        let heartbeat: Heartbeat = cdr::decode(bytes).map_err(|_| Rejection::Malformed)?;
        let finite = [heartbeat.rate, heartbeat.speed];
        let sound = finite.iter().all(|n| n.is_finite());
        return sound.then_some(heartbeat).ok_or(Rejection::NotFinite);
    }
    let instance = field(12, 8).and_then(|b| Some(u64::from_le_bytes(b.try_into().ok()?)));
    Ok(Heartbeat {
        protocol,
        instance: instance.ok_or(Rejection::Malformed)?,
        program: "a program".into(),
        version: "of another version".into(),
        finger: NO_FINGER,
        sequence: 1,
        ..Heartbeat::default()
    })
}

fn works(heartbeat: &Heartbeat) -> bool {
    ["sense", "hand", "world"].contains(&heartbeat.program.as_str())
}

fn name(heartbeat: &Heartbeat) -> String {
    match heartbeat.finger {
        NO_FINGER => heartbeat.program.clone(),
        finger => format!("{} of finger {finger}", heartbeat.program),
    }
}

/// As much of a hash as a person compares.
fn short(hash: &str) -> String {
    match hash.get(..12) {
        Some(start) => start.into(),
        None if hash.is_empty() => "none".into(),
        None => hash.into(),
    }
}
