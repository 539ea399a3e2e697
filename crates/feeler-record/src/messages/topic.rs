//! Topics of a recording. Each carries messages of one type.

use super::chain::{ChainCommand, ChainJoints};
use super::channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, ObjectPose, RecordingGap, Tactile,
    TactileSample, Task, TorqueSensor, TrueSlip,
};
use super::efforts::Efforts;
use super::facts::RunFacts;
use super::felt::Felt;
use super::image::Image;
use super::recorded::{Conversion, ReadInto, RecordedMessage};
use crate::error::RecordError;
use crate::ros::{JointState, MarkerArray, PointCloud2, TFMessage, Text, WrenchStamped};
use std::fmt;
use std::marker::PhantomData;

/// A topic of a recording that carries messages of type `M`.
pub struct RecordedTopic<M> {
    name: &'static str,
    finger: Option<usize>,
    message: PhantomData<fn() -> M>,
}

impl<M> RecordedTopic<M> {
    /// Creates the topic `name` of the whole rig.
    pub(crate) const fn of_rig(name: &'static str) -> Self {
        Self {
            name,
            finger: None,
            message: PhantomData,
        }
    }

    const fn of_finger(finger: usize, name: &'static str) -> Self {
        Self {
            name,
            finger: Some(finger),
            message: PhantomData,
        }
    }

    /// This topic, with messages in the wire format of `N`.
    fn encoded_as<N>(self) -> RecordedTopic<N> {
        RecordedTopic {
            name: self.name,
            finger: self.finger,
            message: PhantomData,
        }
    }

    /// Index of the finger that the messages describe, or `None` for the whole rig.
    pub fn finger(self) -> Option<usize> {
        self.finger
    }

    /// Name of the topic in the recording.
    pub fn name(self) -> String {
        name(self.name, self.finger)
    }

    /// Checks that the topic exists in a rig with `fingers` fingers.
    pub(crate) fn check_finger(self, fingers: usize) -> Result<(), RecordError> {
        match self.finger {
            Some(actual) if actual >= fingers => Err(RecordError::Finger { fingers, actual }),
            _ => Ok(()),
        }
    }
}

impl<M> Clone for RecordedTopic<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for RecordedTopic<M> {}

impl<M> fmt::Debug for RecordedTopic<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Topic({})", self.name())
    }
}

fn name(topic: &str, finger: Option<usize>) -> String {
    match finger {
        Some(finger) => format!("/finger/{finger}/{topic}"),
        None => format!("/{topic}"),
    }
}

/// The topics of a run's recording.
pub mod topics {
    use super::*;

    /// Tri-axial forces of a finger.
    pub const fn tactile(finger: usize) -> RecordedTopic<Tactile> {
        RecordedTopic::of_finger(finger, "tactile")
    }

    /// Tri-axial forces of a finger between two control steps. Only written if the sensor is faster than the control
    /// loop.
    pub const fn samples(finger: usize) -> RecordedTopic<TactileSample> {
        RecordedTopic::of_finger(finger, "samples")
    }

    /// Flags of a finger.
    pub const fn flags(finger: usize) -> RecordedTopic<Flags> {
        RecordedTopic::of_finger(finger, "flags")
    }

    /// Encoder readings of a finger.
    pub const fn joints(finger: usize) -> RecordedTopic<Joints> {
        RecordedTopic::of_finger(finger, "joints")
    }

    /// Commands to a finger.
    pub const fn command(finger: usize) -> RecordedTopic<Command> {
        RecordedTopic::of_finger(finger, "command")
    }

    /// Poses of a fingertip.
    pub const fn fingertip(finger: usize) -> RecordedTopic<Fingertip> {
        RecordedTopic::of_finger(finger, "fingertip")
    }

    /// Efforts of a finger's drives. Only written if the drives measure them.
    pub const fn efforts(finger: usize) -> RecordedTopic<Efforts> {
        RecordedTopic::of_finger(finger, "efforts")
    }

    /// Images of the camera in a finger's fingertip. Only written if images are recorded.
    pub const fn image(finger: usize) -> RecordedTopic<Image> {
        RecordedTopic::of_finger(finger, "image")
    }

    /// Samples of the torque sensor.
    pub const TORQUE_SENSOR: RecordedTopic<TorqueSensor> = RecordedTopic::of_rig("torque_sensor");
    /// True states of the cap.
    pub const CAP: RecordedTopic<Cap> = RecordedTopic::of_rig("cap");
    /// State of the task.
    pub const TASK: RecordedTopic<Task> = RecordedTopic::of_rig("task");
    /// Findings of the task.
    pub const FINDINGS: RecordedTopic<Findings> = RecordedTopic::of_rig("findings");
    /// True poses of the carried object. Empty if no object is free.
    pub const OBJECT: RecordedTopic<ObjectPose> = RecordedTopic::of_rig("object");
    /// True slip of the feelers. Only written by simulated worlds.
    pub const TRUE_SLIP: RecordedTopic<TrueSlip> = RecordedTopic::of_rig("true_slip");
    /// Rumble and tone that the live page played. Only written by runs with such a page; not part of the digest.
    pub const FELT: RecordedTopic<Felt> = RecordedTopic::of_rig("felt");
    /// Gaps in the recording. Only written if messages were dropped.
    pub const RECORDING_GAP: RecordedTopic<RecordingGap> = RecordedTopic::of_rig("recording_gap");

    // For viewers: derived from the other messages.

    /// Transforms of moving frames.
    pub const TF: RecordedTopic<TFMessage> = RecordedTopic::of_rig("tf");
    /// Transforms of fixed frames. Written once.
    pub const TF_STATIC: RecordedTopic<TFMessage> = RecordedTopic::of_rig("tf_static");
    /// URDF of the hand and the solids around it. Written once.
    pub const ROBOT_DESCRIPTION: RecordedTopic<Text> = RecordedTopic::of_rig("robot_description");
    /// Angles and velocities of all joints.
    pub const JOINT_STATES: RecordedTopic<JointState> = RecordedTopic::of_rig("joint_states");
    /// Markers of the scene: solids once, forces repeatedly.
    pub const SCENE: RecordedTopic<MarkerArray> = RecordedTopic::of_rig("scene");

    /// Wrench on a finger's fingertip, in the dome's frame.
    pub const fn wrench(finger: usize) -> RecordedTopic<WrenchStamped> {
        RecordedTopic::of_finger(finger, "wrench")
    }

    /// Position of each element of a finger and the force on it, in the dome's frame.
    pub const fn taxels(finger: usize) -> RecordedTopic<PointCloud2> {
        RecordedTopic::of_finger(finger, "taxels")
    }
}

/// A topic whose message type is only known at run time.
#[derive(Clone, Copy)]
pub(crate) struct Channel {
    name: &'static str,
    pub finger: Option<usize>,
    /// Name and text of the schema.
    pub schema: (&'static str, &'static str),
    pub read_into: ReadInto,
    pub derived: bool,
    pub stored: Option<Conversion>,
}

impl Channel {
    /// The channels of the run described by `facts`, in the order of the recording. Channels for viewers are included
    /// if the hand's geometry is known; channels of images, if `pictures` is set, are last.
    pub fn of_run(facts: &RunFacts, pictures: bool) -> Vec<Self> {
        let fingers = facts.fingers;
        let mut channels = Vec::new();
        for finger in 0..fingers {
            channels.extend([
                Self::from(topics::tactile(finger)),
                topics::flags(finger).into(),
            ]);
            channels.extend(match facts.has_three_joints(finger) {
                true => [
                    Self::from(topics::joints(finger)),
                    topics::command(finger).into(),
                ],
                false => [
                    Self::from(topics::joints(finger).encoded_as::<ChainJoints>()),
                    topics::command(finger).encoded_as::<ChainCommand>().into(),
                ],
            });
            channels.push(topics::fingertip(finger).into());
        }
        channels.extend([
            Self::from(topics::TORQUE_SENSOR),
            topics::CAP.into(),
            topics::TASK.into(),
            topics::FINDINGS.into(),
            topics::OBJECT.into(),
            topics::TRUE_SLIP.into(),
        ]);
        if !facts.hand.is_empty() {
            channels.extend([
                Self::from(topics::TF),
                topics::TF_STATIC.into(),
                topics::ROBOT_DESCRIPTION.into(),
                topics::JOINT_STATES.into(),
                topics::SCENE.into(),
            ]);
            for finger in 0..fingers {
                channels.extend([
                    Self::from(topics::wrench(finger)),
                    topics::taxels(finger).into(),
                ]);
            }
        }
        if pictures {
            channels.extend((0..fingers).map(|finger| Self::from(topics::image(finger))));
        }
        channels
    }

    /// The channels of efforts of the run described by `facts`.
    pub fn of_efforts(facts: &RunFacts) -> impl Iterator<Item = Self> + use<> {
        (0..facts.fingers).map(|finger| topics::efforts(finger).into())
    }

    /// All channels that a recording of the run described by `facts` can have.
    pub fn known(facts: &RunFacts) -> impl Iterator<Item = Self> + use<> {
        let others = [topics::RECORDING_GAP.into(), topics::FELT.into()];
        let channels = Self::of_run(facts, true).into_iter().chain(others);
        let channels = channels.chain(Self::of_efforts(facts));
        channels.chain(Self::of_samples(facts.fingers))
    }

    /// The channels of tactile frames between control steps.
    pub fn of_samples(fingers: usize) -> impl Iterator<Item = Self> {
        (0..fingers).map(|finger| topics::samples(finger).into())
    }

    /// Name of the topic in the recording.
    pub fn topic(self) -> String {
        name(self.name, self.finger)
    }

    /// Returns `true` if its messages are written once and remain valid.
    pub fn is_latched(self) -> bool {
        self.is_of(topics::TF_STATIC) || self.is_of(topics::ROBOT_DESCRIPTION)
    }

    /// Returns `true` if this is the channel of `topic`.
    pub fn is_of<M>(self, topic: RecordedTopic<M>) -> bool {
        self.finger == topic.finger && self.name == topic.name
    }
}

impl<M: RecordedMessage> From<RecordedTopic<M>> for Channel {
    fn from(topic: RecordedTopic<M>) -> Self {
        Self {
            name: topic.name,
            finger: topic.finger,
            schema: (M::SCHEMA_NAME, M::SCHEMA),
            read_into: M::read_into,
            derived: M::DERIVED,
            stored: M::CONVERSION,
        }
    }
}
