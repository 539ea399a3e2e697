//! Where a run's messages go: to a file, or into memory when nobody wants the file.

use super::channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, ObjectPose, Stamped, Tactile, Task,
    TorqueSensor, TrueSlip,
};
use super::error::RecordError;
use super::facts::RunFacts;
use super::image::Image;
use super::recorder::{Recorder, nanoseconds};
use super::recording::{FingerRecord, Recording};

/// Takes the messages of a run, each in the order of time.
pub trait MessageSink {
    /// Takes a finger's tactile frame.
    ///
    /// # Errors
    /// As all of them: unknown finger, a stamp that is no time, or a file that cannot be written.
    fn tactile(&mut self, finger: usize, message: &Tactile) -> Result<(), RecordError>;
    /// Takes a finger's flags.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn flags(&mut self, finger: usize, message: &Flags) -> Result<(), RecordError>;
    /// Takes a finger's encoder reading.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn joints(&mut self, finger: usize, message: &Joints) -> Result<(), RecordError>;
    /// Takes a finger's command.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn command(&mut self, finger: usize, message: &Command) -> Result<(), RecordError>;
    /// Takes a fingertip's pose.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn fingertip(&mut self, finger: usize, message: &Fingertip) -> Result<(), RecordError>;
    /// Takes a sample of the torque sensor.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn torque_sensor(&mut self, message: &TorqueSensor) -> Result<(), RecordError>;
    /// Takes the cap's state.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn cap(&mut self, message: &Cap) -> Result<(), RecordError>;
    /// Takes where the task stands.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn task(&mut self, message: &Task) -> Result<(), RecordError>;
    /// Takes what the task found out.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn findings(&mut self, message: &Findings) -> Result<(), RecordError>;
    /// Takes where the carried object is.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn object(&mut self, message: &ObjectPose) -> Result<(), RecordError>;
    /// Takes how far feelers slipped.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    fn true_slip(&mut self, message: &TrueSlip) -> Result<(), RecordError>;
    /// Takes the picture that a finger's newest forces come from.
    ///
    /// # Errors
    /// As [`Self::tactile`], and when there are to be no pictures.
    fn image(&mut self, finger: usize, message: &Image) -> Result<(), RecordError>;
}

impl MessageSink for Recorder {
    fn tactile(&mut self, finger: usize, message: &Tactile) -> Result<(), RecordError> {
        Self::tactile(self, finger, message)
    }
    fn flags(&mut self, finger: usize, message: &Flags) -> Result<(), RecordError> {
        Self::flags(self, finger, message)
    }
    fn joints(&mut self, finger: usize, message: &Joints) -> Result<(), RecordError> {
        Self::joints(self, finger, message)
    }
    fn command(&mut self, finger: usize, message: &Command) -> Result<(), RecordError> {
        Self::command(self, finger, message)
    }
    fn fingertip(&mut self, finger: usize, message: &Fingertip) -> Result<(), RecordError> {
        Self::fingertip(self, finger, message)
    }
    fn torque_sensor(&mut self, message: &TorqueSensor) -> Result<(), RecordError> {
        Self::torque_sensor(self, message)
    }
    fn cap(&mut self, message: &Cap) -> Result<(), RecordError> {
        Self::cap(self, message)
    }
    fn task(&mut self, message: &Task) -> Result<(), RecordError> {
        Self::task(self, message)
    }
    fn findings(&mut self, message: &Findings) -> Result<(), RecordError> {
        Self::findings(self, message)
    }
    fn object(&mut self, message: &ObjectPose) -> Result<(), RecordError> {
        Self::object(self, message)
    }
    fn true_slip(&mut self, message: &TrueSlip) -> Result<(), RecordError> {
        Self::true_slip(self, message)
    }
    fn image(&mut self, finger: usize, message: &Image) -> Result<(), RecordError> {
        Self::image(self, finger, message)
    }
}

/// A run's messages in memory: what reading its recording would give, but for the digest, which
/// is of encoded messages, and for joints and commands, which no measure is made of.
pub struct MemoryRecorder {
    recording: Recording,
}

impl MemoryRecorder {
    /// For a run of these constants.
    ///
    /// # Errors
    /// When the facts make no sense.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        facts.validate()?;
        let recording = Recording::empty(facts.clone());
        Ok(Self { recording })
    }

    /// What was recorded.
    pub fn into_recording(self) -> Recording {
        self.recording
    }

    fn take<M: Stamped + Clone>(
        &mut self,
        message: &M,
        list: fn(&mut Recording) -> &mut Vec<M>,
    ) -> Result<(), RecordError> {
        let stamp = message.stamp();
        // As in the file, whose clock counts nanoseconds.
        let time = nanoseconds(stamp).ok_or_else(|| RecordError::Stamp {
            topic: M::SCHEMA_NAME.to_string(),
            stamp,
        })?;
        let recording = &mut self.recording;
        recording.readable_until = recording.readable_until.max(time as f64 * 1e-9);
        list(recording).push(message.clone());
        Ok(())
    }

    fn take_felt<M: Stamped + Clone>(
        &mut self,
        finger: usize,
        message: &M,
        list: fn(&mut FingerRecord) -> &mut Vec<M>,
    ) -> Result<(), RecordError> {
        let fingers = self.recording.fingers.len();
        let stamp = message.stamp();
        let time = nanoseconds(stamp).ok_or_else(|| RecordError::Stamp {
            topic: M::SCHEMA_NAME.to_string(),
            stamp,
        })?;
        let record = (self.recording.fingers.get_mut(finger)).ok_or(RecordError::Finger {
            fingers,
            actual: finger,
        })?;
        list(record).push(message.clone());
        let until = &mut self.recording.readable_until;
        *until = until.max(time as f64 * 1e-9);
        Ok(())
    }
}

impl MessageSink for MemoryRecorder {
    fn tactile(&mut self, finger: usize, message: &Tactile) -> Result<(), RecordError> {
        self.take_felt(finger, message, |record| &mut record.tactile)
    }
    fn flags(&mut self, finger: usize, message: &Flags) -> Result<(), RecordError> {
        self.take_felt(finger, message, |record| &mut record.flags)
    }
    fn joints(&mut self, _: usize, _: &Joints) -> Result<(), RecordError> {
        Ok(())
    }
    fn command(&mut self, _: usize, _: &Command) -> Result<(), RecordError> {
        Ok(())
    }
    fn fingertip(&mut self, finger: usize, message: &Fingertip) -> Result<(), RecordError> {
        self.take_felt(finger, message, |record| &mut record.fingertip)
    }
    fn torque_sensor(&mut self, message: &TorqueSensor) -> Result<(), RecordError> {
        self.take(message, |recording| &mut recording.torque_sensor)
    }
    fn cap(&mut self, message: &Cap) -> Result<(), RecordError> {
        self.take(message, |recording| &mut recording.cap)
    }
    fn task(&mut self, message: &Task) -> Result<(), RecordError> {
        self.take(message, |recording| &mut recording.task)
    }
    fn findings(&mut self, message: &Findings) -> Result<(), RecordError> {
        self.take(message, |recording| &mut recording.findings)
    }
    fn object(&mut self, message: &ObjectPose) -> Result<(), RecordError> {
        self.take(message, |recording| &mut recording.object)
    }
    fn true_slip(&mut self, message: &TrueSlip) -> Result<(), RecordError> {
        self.take(message, |recording| &mut recording.true_slip)
    }
    fn image(&mut self, _: usize, _: &Image) -> Result<(), RecordError> {
        Err(RecordError::NoPictures)
    }
}
