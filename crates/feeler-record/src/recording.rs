//! A recording in memory.

use super::channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, ObjectPose, RecordingGap, Stamped, Tactile,
    Task, TorqueSensor, TrueSlip,
};
use super::digest::{Digest, Digester};
use super::facts::RunFacts;
use super::newest::older_than_newest;
use super::options::PolicyFile;
use super::run_end::{RunEnd, RunState};
use super::scan::Place;
use std::collections::BTreeMap;

/// What one finger recorded, each list in the order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FingerRecord {
    /// Tactile frames.
    pub tactile: Vec<Tactile>,
    /// Flags.
    pub flags: Vec<Flags>,
    /// Encoder readings.
    pub joints: Vec<Joints>,
    /// Commands.
    pub command: Vec<Command>,
    /// Fingertip poses.
    pub fingertip: Vec<Fingertip>,
    /// Where its camera's pictures are, if they were recorded: one for each sequence number of `tactile`.
    pub pictures: Vec<PictureAt>,
}

/// A picture that was left in its file: there are far more of them than fit into memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureAt {
    /// Time of the picture, ns.
    pub log_time: u64,
    /// Where its message begins: bytes from the start of the file, or of what a compressed chunk holds.
    pub offset: u64,
    /// Length of the message, bytes.
    pub length: usize,
    /// Where the body of that chunk begins, bytes from the start of the file; `None` if the picture is in no compressed chunk.
    pub chunk: Option<u64>,
}

impl PictureAt {
    /// Of the message of `length` bytes in the record with this body.
    pub(super) fn new(log_time: u64, record: Place, length: usize) -> Self {
        Self {
            log_time,
            offset: record.offset + MESSAGE_HEAD,
            length,
            chunk: record.chunk,
        }
    }
}

/// What stands before a message's bytes in its record: channel, sequence number and two times.
const MESSAGE_HEAD: u64 = 2 + 4 + 8 + 8;

/// A place in a recording where messages are missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// What is missing.
    pub missing: RecordingGap,
    /// Control steps on record before it. Whole steps are missing.
    pub steps_before: usize,
}

/// A part of a file that is of no use, in the middle of what is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Where it is, and what is wrong.
    pub reason: String,
    /// Control steps on record before it; the largest number where it holds none.
    pub steps_before: usize,
}

/// A recording in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The run's constants.
    pub facts: RunFacts,
    /// The experiment as run (TOML).
    pub experiment: String,
    /// The calibration files that the experiment names: name to text. Empty in a recording of forces that were
    /// not calibrated.
    pub calibrations: BTreeMap<String, String>,
    /// The policy that the experiment names, if it does.
    pub policy: Option<PolicyFile>,
    /// How the run ended.
    pub end: RunEnd,
    /// Wall time of the run, s, if it was written.
    pub wall_time: Option<f64>,
    /// Digest of what was read.
    pub digest: Digest,
    /// Whether the recording is whole, without gaps, and its digest is the one it was closed with.
    pub complete: bool,
    /// Time of the latest message that was read, s; 0 if none.
    pub readable_until: f64,
    /// What is wrong with it, if it is not complete.
    pub problem: Option<String>,
    /// One entry per finger.
    pub fingers: Vec<FingerRecord>,
    /// Samples of the torque sensor.
    pub torque_sensor: Vec<TorqueSensor>,
    /// States of the cap.
    pub cap: Vec<Cap>,
    /// Where the task stood.
    pub task: Vec<Task>,
    /// What the task found out, each time that it found out more.
    pub findings: Vec<Findings>,
    /// Where the carried object was, if one is free.
    pub object: Vec<ObjectPose>,
    /// How far feelers slipped, where a simulated world told.
    pub true_slip: Vec<TrueSlip>,
    /// Where messages are missing.
    pub gaps: Vec<Gap>,
    /// The first part of the file that is damaged, where what follows it was read.
    pub damage: Option<Damage>,
    /// Control steps that [`forget_until`](Self::forget_until) let go of.
    pub(super) steps_forgotten: usize,
}

impl Recording {
    pub(super) fn empty(facts: RunFacts) -> Self {
        Self {
            fingers: vec![FingerRecord::default(); facts.fingers],
            facts,
            experiment: String::new(),
            calibrations: BTreeMap::new(),
            policy: None,
            end: RunEnd::because(RunState::Interrupted, "the run was not closed"),
            wall_time: None,
            digest: Digester::default().finish(),
            complete: false,
            readable_until: 0.0,
            problem: None,
            torque_sensor: Vec::new(),
            cap: Vec::new(),
            task: Vec::new(),
            findings: Vec::new(),
            object: Vec::new(),
            true_slip: Vec::new(),
            gaps: Vec::new(),
            damage: None,
            steps_forgotten: 0,
        }
    }

    /// Control steps on record, also those that were let go of.
    pub(super) fn steps_read(&self) -> usize {
        self.steps_forgotten + self.task.len()
    }

    /// Lets go of all messages that no step later than `time` (s) needs, so that a long recording needs little memory:
    /// of each list, what is older than the message that was newest at `time`. Findings and poses of the carried
    /// object stay, as they tell of the whole run.
    pub fn forget_until(&mut self, time: f64) {
        for finger in &mut self.fingers {
            forget(&mut finger.tactile, time);
            forget(&mut finger.flags, time);
            forget(&mut finger.joints, time);
            forget(&mut finger.command, time);
            forget(&mut finger.fingertip, time);
            finger.pictures.clear();
        }
        forget(&mut self.torque_sensor, time);
        forget(&mut self.cap, time);
        forget(&mut self.true_slip, time);
        self.steps_forgotten += forget(&mut self.task, time);
    }

    /// Control steps from the beginning among which none is missing.
    pub fn steps_in_a_row(&self) -> usize {
        let gap = self.gaps.first().map(|gap| gap.steps_before);
        let damage = self.damage.as_ref().map(|damage| damage.steps_before);
        let first = gap.into_iter().chain(damage).min();
        first.map_or(self.steps_read(), |first| first.min(self.steps_read()))
    }

    /// What is missing, in words, if something is.
    pub fn missing(&self) -> Option<String> {
        let first = self.gaps.first()?.missing;
        let messages: u64 = self.gaps.iter().map(|gap| gap.missing.messages).sum();
        let place = match self.gaps.as_slice() {
            [_] => format!("from {:.2} s to {:.2} s", first.start, first.end),
            gaps => format!(
                "in {} gaps, the first from {:.2} s to {:.2} s",
                gaps.len(),
                first.start,
                first.end
            ),
        };
        Some(format!(
            "{messages} messages are missing {place}, as the disk took nothing then"
        ))
    }
}

/// Removes what is older than the message that is newest at `time`, s; how many messages that is.
fn forget<M: Stamped>(messages: &mut Vec<M>, time: f64) -> usize {
    let count = older_than_newest(messages, time);
    messages.drain(..count);
    count
}
