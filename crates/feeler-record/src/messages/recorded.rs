//! Message types of a recording, each with the list of a [`Recording`] that its messages are read into.

use super::chain::{ChainCommand, ChainJoints};
use super::channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, Moments, ObjectPose, RecordingGap, Stamped,
    Tactile, TactileSample, Task, TorqueSensor, TrueSlip,
};
use super::contact::Contact;
use super::efforts::Efforts;
use super::felt::Felt;
use super::image::{Image, compress, size};
use crate::error::RecordError;
use crate::reading::recording::{Gap, PictureAt, Recording};
use crate::ros::CompressedImage;
use crate::wire::cdr;
use std::any::Any;

/// A message type that can be recorded.
pub trait RecordedMessage: Stamped + Clone + Any {
    /// `true` if messages are not part of the digest, because they are derived from others. Those for viewers are not
    /// read back.
    const DERIVED: bool = false;
    /// Converts an encoded message to its recorded form, on the recorder's thread. `None` if the message is recorded as
    /// is.
    const CONVERSION: Option<Conversion> = None;

    /// The list of `recording` that stores messages of this type: of `finger`, or of the rig. `None` if there is no
    /// such finger, or if messages of this type are not kept in memory, which is the default.
    fn list(recording: &mut Recording, finger: Option<usize>) -> Option<&mut Vec<Self>> {
        let _ = (recording, finger);
        None
    }

    /// Checks the fields of a decoded message beyond its stamp.
    ///
    /// # Errors
    /// If they contradict each other. Returns a description.
    fn check_fields(&self) -> Result<(), String> {
        Ok(())
    }

    /// Decodes a message and appends it to its list. `at` is the position of its bytes in the file.
    ///
    /// # Errors
    /// If `bytes` is invalid. Returns a description.
    fn read_into(
        recording: &mut Recording,
        finger: Option<usize>,
        bytes: &[u8],
        at: PictureAt,
    ) -> Result<(), String> {
        let _ = at;
        let message: Self = decode_stamped(bytes)?;
        message.check_fields()?;
        if let Some(list) = Self::list(recording, finger) {
            list.push(message);
        }
        Ok(())
    }
}

/// Decodes a message, whose stamp must be finite.
fn decode_stamped<M: Stamped>(bytes: &[u8]) -> Result<M, String> {
    let message: M = cdr::decode(bytes).map_err(|e| e.to_string())?;
    match message.stamp() {
        stamp if stamp.is_finite() => Ok(message),
        stamp => Err(format!("expected a finite stamp, got {stamp}")),
    }
}

/// Implements [`RecordedMessage`] for message types of a finger and of the rig, each with its list.
macro_rules! recorded {
    (finger: $($of_finger:ident in $finger_list:ident),+; rig: $($of_rig:ident in $rig_list:ident),+ $(,)?) => {
        $(impl RecordedMessage for $of_finger {
            fn list(recording: &mut Recording, finger: Option<usize>) -> Option<&mut Vec<Self>> {
                Some(&mut recording.fingers.get_mut(finger?)?.$finger_list)
            }
        })+
        $(impl RecordedMessage for $of_rig {
            fn list(recording: &mut Recording, _: Option<usize>) -> Option<&mut Vec<Self>> {
                Some(&mut recording.$rig_list)
            }
        })+
    };
}

recorded!(
    finger: Tactile in tactile,
    TactileSample in samples,
    Flags in flags,
    Joints in joints,
    Command in command,
    Fingertip in fingertip;
    rig: TorqueSensor in torque_sensor,
    Cap in cap,
    Task in task,
    Findings in findings,
    ObjectPose in object,
    TrueSlip in true_slip,
);

/// Implements [`RecordedMessage`] for wire formats, whose messages are stored as another type.
macro_rules! stored_as {
    ($($wire:ident as $stored:ident),+) => {
        $(impl RecordedMessage for $wire {
            fn read_into(
                recording: &mut Recording,
                finger: Option<usize>,
                bytes: &[u8],
                _: PictureAt,
            ) -> Result<(), String> {
                let message = $stored::try_from(decode_stamped::<Self>(bytes)?)?;
                if let Some(list) = $stored::list(recording, finger) {
                    list.push(message);
                }
                Ok(())
            }
        })+
    };
}

stored_as!(ChainJoints as Joints, ChainCommand as Command);

/// Efforts are only written if the drives measure them.
impl RecordedMessage for Efforts {
    fn list(recording: &mut Recording, finger: Option<usize>) -> Option<&mut Vec<Self>> {
        Some(&mut recording.fingers.get_mut(finger?)?.efforts)
    }

    fn check_fields(&self) -> Result<(), String> {
        self.check()
    }
}

/// Not part of the digest, because rumble and tone do not change a run.
impl RecordedMessage for Felt {
    const DERIVED: bool = true;

    fn list(recording: &mut Recording, _: Option<usize>) -> Option<&mut Vec<Self>> {
        Some(&mut recording.felt)
    }
}

// Only written to sensor files, which contain no run.
impl RecordedMessage for Moments {}
impl RecordedMessage for Contact {}

/// Images are not read into memory; a recording in memory only stores the position of each image in the file.
impl RecordedMessage for Image {
    const CONVERSION: Option<Conversion> = Some(compress);

    fn read_into(
        recording: &mut Recording,
        finger: Option<usize>,
        bytes: &[u8],
        at: PictureAt,
    ) -> Result<(), String> {
        let image: CompressedImage = cdr::decode(bytes).map_err(|e| e.to_string())?;
        size(&image)?;
        if let Some(finger) = finger.and_then(|finger| recording.fingers.get_mut(finger)) {
            finger.pictures.push(at);
        }
        Ok(())
    }
}

/// Gaps are written by the recorder itself if it dropped messages.
impl RecordedMessage for RecordingGap {
    fn read_into(
        recording: &mut Recording,
        _: Option<usize>,
        bytes: &[u8],
        _: PictureAt,
    ) -> Result<(), String> {
        let gap: Self = cdr::decode(bytes).map_err(|e| e.to_string())?;
        if !(gap.start.is_finite() && gap.end.is_finite()) {
            let (start, end) = (gap.start, gap.end);
            return Err(format!("expected finite times, got {start} and {end}"));
        }
        recording.gaps.push(Gap {
            missing: gap,
            steps_before: recording.steps_read(),
        });
        Ok(())
    }
}

/// [`RecordedMessage::CONVERSION`] of a topic's messages.
pub type Conversion = fn(&[u8]) -> Result<Vec<u8>, RecordError>;

/// [`RecordedMessage::read_into`] of a topic's messages.
pub(super) type ReadInto =
    fn(&mut Recording, Option<usize>, &[u8], PictureAt) -> Result<(), String>;
