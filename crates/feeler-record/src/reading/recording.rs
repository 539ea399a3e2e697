//! A recording in memory.

use super::digest::{Digest, Digester};
use super::scan::Place;
use crate::messages::channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, ObjectPose, RecordingGap, Stamped, Tactile,
    TactileSample, Task, TorqueSensor, TrueSlip,
};
use crate::messages::efforts::Efforts;
use crate::messages::facts::RunFacts;
use crate::messages::felt::Felt;
use crate::messages::run_end::{RunEnd, RunState};
use crate::writing::newest::count_before_latest;
use crate::writing::options::PolicyFile;
use std::collections::BTreeMap;

/// Messages of one finger, each list in order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FingerRecord {
    /// Latest tactile frame at each control step.
    pub tactile: Vec<Tactile>,
    /// Tactile frames between those of the control steps, if the sensor is faster than the control loop.
    pub samples: Vec<TactileSample>,
    /// Flags.
    pub flags: Vec<Flags>,
    /// Encoder readings.
    pub joints: Vec<Joints>,
    /// Efforts of the drives, if recorded: one per reading in `joints`.
    pub efforts: Vec<Efforts>,
    /// Commands.
    pub command: Vec<Command>,
    /// Fingertip poses.
    pub fingertip: Vec<Fingertip>,
    /// Positions of its camera's images, if recorded: one per sequence number in `tactile`.
    pub pictures: Vec<PictureAt>,
}

/// Position of an image that was left in its file, because images do not fit into memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureAt {
    /// Time of the image (ns).
    pub log_time: u64,
    /// Offset of the image's message in bytes: from the start of the file, or of the decompressed chunk.
    pub offset: u64,
    /// Length of the message in bytes.
    pub length: usize,
    /// Offset of the compressed chunk's body from the start of the file in bytes, or `None` if the image is not in a
    /// compressed chunk.
    pub chunk: Option<u64>,
}

impl PictureAt {
    /// Position of the message of `length` bytes whose record body is at `record`.
    pub(crate) fn new(log_time: u64, record: Place, length: usize) -> Self {
        Self {
            log_time,
            offset: record.offset + MESSAGE_HEAD,
            length,
            chunk: record.chunk,
        }
    }
}

/// Size of a message's header in its record: channel, sequence number and two times.
const MESSAGE_HEAD: u64 = 2 + 4 + 8 + 8;

/// A gap in a recording where messages are missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Times and number of the missing messages.
    pub missing: RecordingGap,
    /// Number of recorded control steps before the gap. Gaps consist of whole steps.
    pub steps_before: usize,
}

/// A damaged part of a file that is followed by readable parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Position and kind of the damage.
    pub reason: String,
    /// Number of recorded control steps before the damage, or `usize::MAX` if the damaged part contains no steps.
    pub steps_before: usize,
}

/// A recording in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The run's constants.
    pub facts: RunFacts,
    /// The experiment as run (TOML).
    pub experiment: String,
    /// Text of each calibration file named in the experiment, by name. Empty if forces were not calibrated.
    pub calibrations: BTreeMap<String, String>,
    /// Learned policy named in the experiment, if any.
    pub policy: Option<PolicyFile>,
    /// The end of the run.
    pub end: RunEnd,
    /// Wall time of the run (s), if recorded.
    pub wall_time: Option<f64>,
    /// Digest of the messages that were read.
    pub digest: Digest,
    /// `true` if the recording has no damage or gaps, and its digest matches the one written at its end.
    pub complete: bool,
    /// Time of the latest message that was read (s), or 0 if there are no messages.
    pub readable_until: f64,
    /// Description of the problem if the recording is not complete.
    pub problem: Option<String>,
    /// One entry per finger.
    pub fingers: Vec<FingerRecord>,
    /// Samples of the torque sensor.
    pub torque_sensor: Vec<TorqueSensor>,
    /// States of the cap.
    pub cap: Vec<Cap>,
    /// States of the task.
    pub task: Vec<Task>,
    /// Findings of the task, one entry per change.
    pub findings: Vec<Findings>,
    /// Poses of the carried object, if one is free.
    pub object: Vec<ObjectPose>,
    /// True slip of the feelers, if recorded by a simulated world.
    pub true_slip: Vec<TrueSlip>,
    /// Rumble and tone that the live page played, if the run had one.
    pub felt: Vec<Felt>,
    /// Gaps where messages are missing.
    pub gaps: Vec<Gap>,
    /// First damaged part of the file that is followed by readable parts.
    pub damage: Option<Damage>,
    /// Number of control steps discarded by [`discard_until`](Self::discard_until).
    pub(crate) discarded_steps: usize,
}

impl Recording {
    pub(crate) fn empty(facts: RunFacts) -> Self {
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
            felt: Vec::new(),
            gaps: Vec::new(),
            damage: None,
            discarded_steps: 0,
        }
    }

    /// Returns `true` if efforts of the drives were recorded.
    pub fn has_efforts(&self) -> bool {
        self.fingers.iter().any(|finger| !finger.efforts.is_empty())
    }

    /// Number of recorded control steps, including discarded ones.
    pub(crate) fn steps_read(&self) -> usize {
        self.discarded_steps + self.task.len()
    }

    /// Discards all messages that no step later than `time` (s) needs, to limit the memory of a long recording: in each
    /// list, those older than the latest message at `time`. Findings and poses of the carried object are kept, because
    /// they are needed for the whole run.
    pub fn discard_until(&mut self, time: f64) {
        for finger in &mut self.fingers {
            forget(&mut finger.tactile, time);
            forget(&mut finger.samples, time);
            forget(&mut finger.flags, time);
            forget(&mut finger.joints, time);
            forget(&mut finger.efforts, time);
            forget(&mut finger.command, time);
            forget(&mut finger.fingertip, time);
            finger.pictures.clear();
        }
        forget(&mut self.torque_sensor, time);
        forget(&mut self.cap, time);
        forget(&mut self.true_slip, time);
        forget(&mut self.felt, time);
        self.discarded_steps += forget(&mut self.task, time);
    }

    /// Number of control steps from the start without a gap or damage.
    pub fn leading_complete_steps(&self) -> usize {
        let gap = self.gaps.first().map(|gap| gap.steps_before);
        let damage = self.damage.as_ref().map(|damage| damage.steps_before);
        let first = gap.into_iter().chain(damage).min();
        first.map_or(self.steps_read(), |first| first.min(self.steps_read()))
    }

    /// Describes the missing messages, or returns `None` if the recording has no gaps.
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
            "{messages} messages are missing {place}, because the disk accepted no data"
        ))
    }
}

/// Removes all messages before the one that is current at `time` (s). Returns the number of removed messages.
fn forget<M: Stamped>(messages: &mut Vec<M>, time: f64) -> usize {
    let count = count_before_latest(messages, time);
    messages.drain(..count);
    count
}
