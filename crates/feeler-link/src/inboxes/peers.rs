//! Other programs of the rig, and whether they are accepted.

use crate::messages::decode::read_heartbeat;
use crate::messages::joints::JointCounts;
use crate::messages::message::{Heartbeat, MessageHeader, NO_FINGER, PROTOCOL, ProgramKind};
use crate::messages::mismatch::{Mismatch, short};
use crate::messages::plausible::check_protocol;
use crate::messages::rejection::Rejection;
use crate::messages::sequence::Sequence;
use crate::transport::topic::ProgramRole;

/// Time without a heartbeat (s) after which a program is considered gone.
pub const SILENT_AFTER: f64 = 1.0;

/// Maximum number of known programs, to limit the effect of floods.
pub const MAX_PEERS: usize = 64;

/// Kinds of programs that operate the rig. All others only observe or send orders.
const WORKING: [ProgramKind; 3] = [ProgramKind::Sense, ProgramKind::Hand, ProgramKind::World];

/// Configuration that other programs must match.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expected {
    /// SHA-256 of the experiment.
    pub experiment: String,
    /// SHA-256 of each finger's fingertip.
    pub fingertips: Vec<String>,
    /// Number of joints of each finger. Follows from the experiment.
    pub joints: JointCounts,
    /// Speed of the rig's time as in [`Heartbeat::speed`], or `None` to accept any speed.
    pub speed: Option<f64>,
}

/// Another program, known from its heartbeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Peer {
    /// Latest heartbeat.
    pub heartbeat: Heartbeat,
    /// Arrival time of the latest heartbeat on this program's clock (s).
    pub heard: f64,
    /// Reason for refusing the program, or `None` if it is accepted.
    pub refused: Option<Mismatch>,
    heartbeats: Sequence,
}

impl Peer {
    /// Returns the display name, such as `hand` or `sense of finger 0`.
    pub fn name(&self) -> String {
        name(&self.heartbeat)
    }

    /// Returns the mismatch for another program that claims this peer's role.
    pub fn taken(&self) -> Mismatch {
        let program = self.name();
        Mismatch::Taken { program }
    }

    /// Returns `true` if the program operates the rig, instead of only observing or sending orders.
    pub fn works(&self) -> bool {
        works(&self.heartbeat)
    }

    /// Returns `true` if no heartbeat has arrived for longer than `SILENT_AFTER` at `now` (s).
    pub fn is_silent(&self, now: f64) -> bool {
        now - self.heard > SILENT_AFTER
    }

    /// Returns the priority for keeping this entry, from 0 (gone) to 3 (accepted and operating the rig).
    fn worth(&self, now: f64) -> u8 {
        match () {
            () if self.is_silent(now) => 0,
            () if self.refused.is_some() => 1,
            () if !works(&self.heartbeat) => 2,
            () => 3,
        }
    }
}

/// All other programs known from heartbeats.
#[derive(Debug, Clone, Default)]
pub struct Peers {
    expected: Expected,
    peers: Vec<Peer>,
}

impl Peers {
    /// Creates an empty list. Programs are accepted if they match `expected`.
    pub fn new(expected: Expected) -> Self {
        Self {
            expected,
            peers: Vec::new(),
        }
    }

    /// Returns the number of joints of each finger.
    pub fn joints(&self) -> &JointCounts {
        &self.expected.joints
    }

    /// Returns all known programs in order of appearance, including silent ones.
    pub fn all(&self) -> &[Peer] {
        &self.peers
    }

    /// Returns the accepted programs of a kind that are present at `now` (s).
    pub fn taken(&self, program: ProgramKind, now: f64) -> impl Iterator<Item = &Peer> {
        self.peers.iter().filter(move |peer| {
            peer.refused.is_none() && peer.heartbeat.program == program && !peer.is_silent(now)
        })
    }

    /// Checks that `instance` is an accepted program of kind `program` for `finger` (or `NO_FINGER`).
    ///
    /// # Errors
    /// If the program is unknown, of another kind or finger, or refused.
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

    /// Checks that a message with this header has this program's protocol version and is from an accepted hand.
    ///
    /// # Errors
    /// If the version differs, or the sender is not an accepted hand.
    pub fn check_hand(&self, header: MessageHeader) -> Result<(), Rejection> {
        check_protocol(header.protocol)?;
        self.check(header.instance, &ProgramKind::Hand, NO_FINGER)
    }

    /// Processes a heartbeat received at `now` (s) on the topic of `place`. Returns the peer if it is new.
    ///
    /// # Errors
    /// If the heartbeat is invalid, belongs to another place, or there are too many programs.
    pub fn heard(
        &mut self,
        place: ProgramRole,
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
            // The identity of an instance must not change.
            if identity(&heartbeat) != identity(&peer.heartbeat) {
                return Err(Rejection::Stranger);
            }
            // The position of the sequence number is unknown in other versions.
            if heartbeat.protocol == PROTOCOL {
                peer.heartbeats.accept(number, now)?;
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

    /// Removes programs that are gone and were refused or do not operate the rig. If the list is still full, removes
    /// the entry of lowest priority, except accepted programs that operate the rig and are present.
    fn make_room(&mut self, now: f64) -> Result<(), Rejection> {
        self.peers
            .retain(|peer| !peer.is_silent(now) || (peer.refused.is_none() && peer.works()));
        if self.peers.len() < MAX_PEERS {
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

    /// Accepts waiting programs whose role has become free.
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

    /// Removes a silent program that `successor` replaces. If it returns, it is treated as another program.
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

/// Returns kind and finger, which identify a role that only one program can have.
fn place(heartbeat: &Heartbeat) -> (&ProgramKind, u32) {
    (&heartbeat.program, heartbeat.finger)
}

/// Returns the properties that determine whether a program is accepted.
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
