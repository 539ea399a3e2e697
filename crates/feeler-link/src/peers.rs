//! Which programs there are, and which of them are taken for what.

use super::heartbeat::read_heartbeat;
use super::message::{Heartbeat, NO_FINGER, PROTOCOL, ProgramKind};
use super::mismatch::{Mismatch, short};
use super::rejection::Rejection;
use super::sequence::Sequence;
use super::topic::Place;

/// A program whose last heartbeat is older than this has gone, s.
pub const SILENT_AFTER: f64 = 1.0;

/// Programs that are remembered at most; a guard against a flood.
pub const MOST_PEERS: usize = 64;

/// The programs that do something for the rig. Others only look or give orders.
const WORKING: [ProgramKind; 3] = [ProgramKind::Sense, ProgramKind::Hand, ProgramKind::World];

/// What a program must agree in with this one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expected {
    /// SHA-256 of the experiment.
    pub experiment: String,
    /// SHA-256 of each finger's fingertip.
    pub fingertips: Vec<String>,
    /// How fast the rig's time goes, as [`Heartbeat::speed`]; none where it does not matter.
    pub speed: Option<f64>,
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
    heartbeats: Sequence,
}

impl Peer {
    /// What it is, in words.
    pub fn name(&self) -> String {
        name(&self.heartbeat)
    }

    /// That its place is taken by it.
    pub fn taken(&self) -> Mismatch {
        let program = self.name();
        Mismatch::Taken { program }
    }

    /// Whether it is part of a rig, and not there only to give an order.
    pub fn works(&self) -> bool {
        works(&self.heartbeat)
    }

    /// Whether it has gone by `now`, s.
    pub fn is_silent(&self, now: f64) -> bool {
        now - self.heard > SILENT_AFTER
    }

    /// How much would be lost with it: 0 nothing, as it has gone, to 3.
    fn worth(&self, now: f64) -> u8 {
        match () {
            () if self.is_silent(now) => 0,
            () if self.refused.is_some() => 1,
            () if !works(&self.heartbeat) => 2,
            () => 3,
        }
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

    /// All of them, gone or not; that which came last is the last.
    pub fn all(&self) -> &[Peer] {
        &self.peers
    }

    /// The programs of a kind that are there and taken.
    pub fn taken(&self, program: ProgramKind, now: f64) -> impl Iterator<Item = &Peer> {
        self.peers.iter().filter(move |peer| {
            peer.refused.is_none() && peer.heartbeat.program == program && !peer.is_silent(now)
        })
    }

    /// Lets pass messages of `instance` that are those of a `program`, of `finger` where it has one.
    ///
    /// # Errors
    /// When it is not known yet, is another program, or was refused.
    pub fn check(
        &self,
        instance: u64,
        program: &ProgramKind,
        finger: u32,
    ) -> Result<(), Rejection> {
        let known = |peer: &&Peer| peer.heartbeat.instance == instance;
        let peer = self.peers.iter().find(known);
        let heartbeat = &peer.ok_or(Rejection::Unintroduced)?.heartbeat;
        let as_expected = heartbeat.program == *program && heartbeat.finger == finger;
        let taken = as_expected && peer.is_some_and(|peer| peer.refused.is_none());
        taken.then_some(()).ok_or(Rejection::Stranger)
    }

    /// Takes in a heartbeat that came at `now`, s, from the program that has this `place`; the peer, if it was not
    /// known before.
    ///
    /// # Errors
    /// When it is none, is of a program of another place, or there are too many programs.
    pub fn heard(
        &mut self,
        place: Place,
        bytes: &[u8],
        now: f64,
    ) -> Result<Option<&Peer>, Rejection> {
        let heartbeat = read_heartbeat(bytes)?;
        if heartbeat.protocol == PROTOCOL && heartbeat.place() != Some(place) {
            return Err(Rejection::Stranger);
        }
        let number = (heartbeat.instance, heartbeat.sequence);
        let known = |peer: &Peer| peer.heartbeat.instance == heartbeat.instance;
        if let Some(peer) = self.peers.iter_mut().find(|peer| known(peer)) {
            // What it is does not change, whatever the bytes say.
            if identity(&heartbeat) != identity(&peer.heartbeat) {
                return Err(Rejection::Stranger);
            }
            // Where the number stands in another version is not known.
            if heartbeat.protocol == PROTOCOL {
                peer.heartbeats.missing(number, now)?;
                peer.heartbeats.take(number, now);
            }
            (peer.heartbeat, peer.heard) = (heartbeat, now);
            self.judge_again(now);
            return Ok(None);
        }
        self.make_room(now)?;
        let refused = self.mismatch(&heartbeat, now);
        if refused.is_none() {
            self.forget_predecessor(&heartbeat);
        }
        let mut heartbeats = Sequence::default();
        heartbeats.take(number, now);
        self.peers.push(Peer {
            heartbeat,
            heard: now,
            refused,
            heartbeats,
        });
        Ok(self.peers.last())
    }

    /// Forgets programs that have gone and were refused or only gave an order, and, where there are still too many, one more; none that is
    /// there, is taken and works.
    fn make_room(&mut self, now: f64) -> Result<(), Rejection> {
        self.peers
            .retain(|peer| !peer.is_silent(now) || (peer.refused.is_none() && peer.works()));
        if self.peers.len() < MOST_PEERS {
            return Ok(());
        }
        let worth = |peer: &Peer| (peer.worth(now), peer.heard);
        let least = self.peers.iter().enumerate().min_by(|(_, a), (_, b)| {
            let ((a, a_heard), (b, b_heard)) = (worth(a), worth(b));
            a.cmp(&b).then(a_heard.total_cmp(&b_heard))
        });
        match least {
            Some((index, peer)) if peer.worth(now) < 3 => {
                self.peers.remove(index);
                Ok(())
            }
            _ => Err(Rejection::Stranger),
        }
    }

    /// A place that was taken may have become free.
    fn judge_again(&mut self, now: f64) {
        let waits = |peer: &Peer| {
            matches!(peer.refused, Some(Mismatch::Taken { .. })) && !peer.is_silent(now)
        };
        let waiting = self.peers.iter().filter(|peer| waits(peer));
        let waiting: Vec<Heartbeat> = waiting.map(|peer| peer.heartbeat.clone()).collect();
        for heartbeat in waiting {
            if self.mismatch(&heartbeat, now).is_none() {
                self.forget_predecessor(&heartbeat);
                let now_taken = |peer: &&mut Peer| peer.heartbeat.instance == heartbeat.instance;
                if let Some(peer) = self.peers.iter_mut().find(now_taken) {
                    peer.refused = None;
                }
            }
        }
    }

    /// Forgets a silent program whose place another takes. Should it speak again, it is a second one.
    fn forget_predecessor(&mut self, successor: &Heartbeat) {
        self.peers.retain(|peer| {
            peer.heartbeat.instance == successor.instance
                || peer.refused.is_some()
                || !works(successor)
                || place(&peer.heartbeat) != place(successor)
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
        let ours = &self.expected.experiment;
        if works(heartbeat) && heartbeat.experiment != *ours {
            return Some(Mismatch::Experiment {
                program,
                theirs: short(&heartbeat.experiment),
                ours: short(ours),
            });
        }
        let finger = usize::try_from(heartbeat.finger).unwrap_or(usize::MAX);
        let ours = self.expected.fingertips.get(finger);
        if heartbeat.program == ProgramKind::Sense && ours != Some(&heartbeat.fingertip) {
            return Some(Mismatch::Fingertip {
                program,
                theirs: short(&heartbeat.fingertip),
                ours: short(ours.map_or("", |f| f)),
            });
        }
        let ours = self.expected.speed.unwrap_or(heartbeat.speed);
        if heartbeat.program == ProgramKind::World && heartbeat.speed != ours {
            let theirs = heartbeat.speed;
            return Some(Mismatch::Speed {
                program,
                theirs,
                ours,
            });
        }
        let same = |peer: &&Peer| {
            peer.refused.is_none()
                && peer.heartbeat.instance != heartbeat.instance
                && !peer.is_silent(now)
                && place(&peer.heartbeat) == place(heartbeat)
        };
        let taken = works(heartbeat) && self.peers.iter().any(|peer| same(&peer));
        taken.then_some(Mismatch::Taken { program })
    }
}

fn works(heartbeat: &Heartbeat) -> bool {
    WORKING.contains(&heartbeat.program)
}

/// What only one program can be.
fn place(heartbeat: &Heartbeat) -> (&ProgramKind, u32) {
    (&heartbeat.program, heartbeat.finger)
}

/// What a program was taken or refused for.
fn identity(heartbeat: &Heartbeat) -> impl PartialEq {
    let Heartbeat {
        protocol,
        experiment,
        fingertip,
        ..
    } = heartbeat;
    (place(heartbeat), *protocol, experiment, fingertip)
}

fn name(heartbeat: &Heartbeat) -> String {
    match heartbeat.finger {
        NO_FINGER => heartbeat.program.to_string(),
        finger => format!("{} of finger {finger}", heartbeat.program),
    }
}
