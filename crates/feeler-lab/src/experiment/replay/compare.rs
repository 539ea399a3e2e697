//! Comparison of a replay with its recording.

use super::fields::{FieldDifference, of_command, of_findings, of_flags, of_tactile, of_task};
use feeler_record::{
    Command, Findings, FingerRecord, Flags, MessageSink, RecordError, RecordedMessage,
    RecordedTopic, Recorder, Recording, Tactile, Task,
};
use std::any::Any;
use std::fmt;

/// Kind of compared data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Forces of one finger.
    Forces,
    /// Flags, grasp force and shear rates of one finger.
    Flags,
    /// Phase and stroke number of the task.
    Phases,
    /// Findings of the task.
    Findings,
    /// Command of one finger.
    Commands,
}

impl Kind {
    /// All kinds, in dependency order.
    pub const ALL: [Self; 5] = [
        Self::Forces,
        Self::Flags,
        Self::Phases,
        Self::Findings,
        Self::Commands,
    ];
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Forces => "forces",
            Self::Flags => "flags",
            Self::Phases => "phases",
            Self::Findings => "findings",
            Self::Commands => "commands",
        })
    }
}

/// A value that differs from the recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Index of the control step.
    pub step: usize,
    /// Time of the step (s).
    pub time: f64,
    /// Index of the finger. `None` for a value of the whole hand.
    pub finger: Option<usize>,
    /// Name of the value.
    pub name: String,
    /// Recorded value.
    pub expected: String,
    /// Replayed value.
    pub actual: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {} ({:.3} s), ", self.step, self.time)?;
        if let Some(finger) = self.finger {
            write!(f, "finger {finger}, ")?;
        }
        let Self {
            name,
            expected,
            actual,
            ..
        } = self;
        write!(f, "{name}: recorded {expected}, replayed {actual}")
    }
}

/// Result of the comparison for one kind.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Number of compared messages.
    pub compared: u64,
    /// Number of messages that are not bit-identical.
    pub differing: u64,
    /// First difference.
    pub first: Option<Difference>,
}

/// Result of comparing a replay with its recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Comparison {
    tallies: [Tally; Kind::ALL.len()],
}

impl Comparison {
    /// Returns the result for `kind`.
    pub fn of(&self, kind: Kind) -> &Tally {
        &self.tallies[kind as usize]
    }

    /// Returns `true` if all values are bit-identical to the recording.
    pub fn same(&self) -> bool {
        self.tallies.iter().all(|tally| tally.differing == 0)
    }
}

/// Compares the messages of a replay with the recording and forwards them to a copy.
pub(super) struct Comparer<'a> {
    recording: &'a Recording,
    /// `true` if forces are compared, `false` if the replay uses the recorded forces.
    forces: bool,
    step: usize,
    time: f64,
    /// Latest findings of the replay.
    found: Findings,
    /// Number of recorded messages with findings up to the current step.
    found_on_record: usize,
    pub comparison: Comparison,
    pub copy: Option<Recorder>,
}

impl<'a> Comparer<'a> {
    pub fn new(recording: &'a Recording, forces: bool) -> Self {
        Self {
            recording,
            forces,
            step: 0,
            time: 0.0,
            found: Findings::default(),
            found_on_record: 0,
            comparison: Comparison::default(),
            copy: None,
        }
    }

    /// Compares a message with the recorded one, by `difference`.
    fn compare<M>(
        &mut self,
        kind: Kind,
        finger: Option<usize>,
        expected: Option<&M>,
        actual: &M,
        difference: fn(&M, &M) -> Option<FieldDifference>,
    ) {
        // The replay has no more steps than the recording.
        let Some(expected) = expected else { return };
        let tally = &mut self.comparison.tallies[kind as usize];
        tally.compared += 1;
        let Some(field) = difference(expected, actual) else {
            return;
        };
        tally.differing += 1;
        tally.first.get_or_insert(Difference {
            step: self.step,
            time: self.time,
            finger,
            name: field.name,
            expected: field.expected,
            actual: field.actual,
        });
    }

    /// Returns the message of this step in one of a finger's recorded lists.
    fn on_record<M>(
        &self,
        finger: usize,
        list: impl FnOnce(&'a FingerRecord) -> &'a Vec<M>,
    ) -> Option<&'a M> {
        list(self.recording.fingers.get(finger)?).get(self.step)
    }

    /// Compares the findings up to this step, if there are any.
    fn compare_findings(&mut self) {
        let on_record = &self.recording.findings;
        let later = on_record.get(self.found_on_record..).unwrap_or_default();
        let now = later.iter().take_while(|found| found.stamp <= self.time);
        self.found_on_record += now.count();
        let nothing = Findings::default();
        let found = std::mem::take(&mut self.found);
        let expected = on_record[..self.found_on_record].last();
        if expected.is_some() || found != nothing {
            let expected = Some(expected.unwrap_or(&nothing));
            self.compare(Kind::Findings, None, expected, &found, of_findings);
        }
        self.found = found;
    }

    fn compare_tactile(&mut self, finger: usize, message: &Tactile) {
        let task = self.recording.task.get(self.step);
        self.time = task.map_or(message.stamp, |task| task.stamp);
        if self.forces {
            let expected = self.on_record(finger, |record| &record.tactile);
            self.compare(Kind::Forces, Some(finger), expected, message, of_tactile);
        }
    }

    fn compare_flags(&mut self, finger: usize, message: &Flags) {
        let expected = self.on_record(finger, |record| &record.flags);
        self.compare(Kind::Flags, Some(finger), expected, message, of_flags);
    }

    fn compare_command(&mut self, finger: usize, message: &Command) {
        let expected = self.on_record(finger, |record| &record.command);
        self.compare(Kind::Commands, Some(finger), expected, message, of_command);
    }

    /// Compares the task message, which is the last message of a step.
    fn compare_task(&mut self, message: &Task) {
        let expected = self.recording.task.get(self.step);
        self.compare(Kind::Phases, None, expected, message, of_task);
        self.compare_findings();
        self.step += 1;
    }
}

impl MessageSink for Comparer<'_> {
    fn is_for_viewers(&self) -> bool {
        self.copy.is_some()
    }

    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let any: &dyn Any = message;
        if let Some(finger) = topic.finger() {
            if let Some(tactile) = any.downcast_ref() {
                self.compare_tactile(finger, tactile);
            } else if let Some(flags) = any.downcast_ref() {
                self.compare_flags(finger, flags);
            } else if let Some(command) = any.downcast_ref() {
                self.compare_command(finger, command);
            }
        } else if let Some(findings) = any.downcast_ref() {
            self.found.clone_from(findings);
        } else if let Some(task) = any.downcast_ref() {
            self.compare_task(task);
        }
        // All other messages are derived from compared ones or belong to the rig.
        match &mut self.copy {
            Some(copy) => copy.write(topic, message),
            None => Ok(()),
        }
    }
}
