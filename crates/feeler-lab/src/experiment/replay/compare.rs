//! What a replay gives, held against what is on record.

use super::fields::{Field, of_command, of_findings, of_flags, of_tactile, of_task};
use feeler_record::{
    Command, Findings, FingerRecord, Flags, MessageSink, RecordError, RecordedMessage,
    RecordedTopic, Recorder, Recording, Tactile, Task,
};
use std::any::Any;
use std::fmt;

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The forces of one finger.
    Forces,
    /// The flags, grasp force and shear rates of one finger.
    Flags,
    /// Phase and stroke of the task.
    Phases,
    /// What the task found out.
    Findings,
    /// The command of one finger.
    Commands,
}

impl Kind {
    /// All of them, in the order in which one follows from the other.
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

/// A value that is not as on record.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The control step, from 0.
    pub step: usize,
    /// Its time, s.
    pub time: f64,
    /// The finger; none where it is of the whole hand.
    pub finger: Option<usize>,
    /// The value's name.
    pub name: String,
    /// What is on record.
    pub expected: String,
    /// What the replay gave.
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
        write!(f, "{name}: {expected} on record, {actual} now")
    }
}

/// How the messages of one kind compare.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Messages that were compared.
    pub compared: u64,
    /// Those in which a value differs by a bit or more.
    pub differing: u64,
    /// The first value that does.
    pub first: Option<Difference>,
}

/// How a replay compares with its recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Comparison {
    tallies: [Tally; Kind::ALL.len()],
}

impl Comparison {
    /// How the messages of `kind` compare.
    pub fn of(&self, kind: Kind) -> &Tally {
        &self.tallies[kind as usize]
    }

    /// Whether everything is as on record, bit for bit.
    pub fn same(&self) -> bool {
        self.tallies.iter().all(|tally| tally.differing == 0)
    }
}

/// Takes a replay's messages, compares them with those on record and passes them on.
pub(super) struct Comparer<'a> {
    recording: &'a Recording,
    /// Whether forces come from pictures; otherwise they are those on record.
    forces: bool,
    step: usize,
    time: f64,
    /// What the task has found out.
    found: Findings,
    /// How many messages about that are on record until here.
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

    fn compare<'b, M: 'b, F: Iterator<Item = Field<'b>>>(
        &mut self,
        kind: Kind,
        finger: Option<usize>,
        expected: Option<&'b M>,
        fields: impl FnOnce(&'b M) -> F,
    ) {
        // There is no step that is not on record.
        let Some(expected) = expected else { return };
        let tally = &mut self.comparison.tallies[kind as usize];
        tally.compared += 1;
        let Some(field) = fields(expected).find(Field::differs) else {
            return;
        };
        tally.differing += 1;
        tally.first.get_or_insert_with(|| Difference {
            step: self.step,
            time: self.time,
            finger,
            name: field.name(),
            expected: field.expected.to_string(),
            actual: field.actual.to_string(),
        });
    }

    /// What a finger has on record of this step in one of its lists.
    fn on_record<M>(
        &self,
        finger: usize,
        list: impl FnOnce(&'a FingerRecord) -> &'a Vec<M>,
    ) -> Option<&'a M> {
        list(self.recording.fingers.get(finger)?).get(self.step)
    }

    /// What the task has found out until this step, where there is anything.
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
            self.compare(Kind::Findings, None, expected, |expected| {
                of_findings(expected, &found)
            });
        }
        self.found = found;
    }

    fn compare_tactile(&mut self, finger: usize, message: &Tactile) {
        let task = self.recording.task.get(self.step);
        self.time = task.map_or(message.stamp, |task| task.stamp);
        if self.forces {
            let expected = self.on_record(finger, |record| &record.tactile);
            self.compare(Kind::Forces, Some(finger), expected, |expected| {
                of_tactile(expected, message)
            });
        }
    }

    fn compare_flags(&mut self, finger: usize, message: &Flags) {
        let expected = self.on_record(finger, |record| &record.flags);
        self.compare(Kind::Flags, Some(finger), expected, |expected| {
            of_flags(expected, message)
        });
    }

    fn compare_command(&mut self, finger: usize, message: &Command) {
        let expected = self.on_record(finger, |record| &record.command);
        self.compare(Kind::Commands, Some(finger), expected, |expected| {
            of_command(expected, message)
        });
    }

    /// The last message of a step.
    fn compare_task(&mut self, message: &Task) {
        let expected = self.recording.task.get(self.step);
        self.compare(Kind::Phases, None, expected, |expected| {
            of_task(expected, message)
        });
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
        // What is not compared follows from the record, or is the rig's own.
        match &mut self.copy {
            Some(copy) => copy.write(topic, message),
            None => Ok(()),
        }
    }
}
