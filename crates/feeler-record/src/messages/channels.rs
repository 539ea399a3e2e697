//! Messages of a recording: one plain struct per message, with its ROS 2 message text.
//!
//! The fields of a struct are in the order of its schema's lines; both define the wire format. All stamps are run times
//! in seconds (simulated or real), not wall-clock times.

use super::joint_array;
use super::names::{FindingName, TaskOutcome};
use crate::wire::{Message, Quaternion, Vector3, message, quaternion_schema, vector3_schema};
use feeler::control::Phase;
use feeler::hand::JointVector;
use serde::{Deserialize, Serialize};

/// Value of [`Flags::largest_element`] if no element touches.
pub const NO_ELEMENT: u32 = u32::MAX;

/// A message with a time stamp.
pub trait Stamped: Message {
    /// Time of the message (s).
    fn stamp(&self) -> f64;
}

/// Rounds a stamp (s) to nanoseconds. `None` if it is not a valid time of a run.
pub(crate) fn nanoseconds(stamp: f64) -> Option<u64> {
    let ns = stamp * 1e9;
    if !(ns > -0.5 && ns < u64::MAX as f64) {
        return None;
    }
    // Rounded by hand: on older processors, `round` is a call to the math library.
    let below = ns as u64;
    Some(below + u64::from(ns - below as f64 >= 0.5))
}

/// Implements [`Stamped`] for structs with a field `stamp`.
macro_rules! stamped {
    ($($type:ident),+ $(,)?) => {
        $(impl $crate::messages::channels::Stamped for $type {
            fn stamp(&self) -> f64 {
                self.stamp
            }
        })+
    };
}

pub(crate) use stamped;

stamped!(
    Tactile,
    TactileSample,
    Moments,
    Flags,
    Joints,
    Command,
    Fingertip,
    TorqueSensor,
    Cap,
    TrueSlip,
    Task,
    Findings,
    ObjectPose
);

/// Tri-axial forces on the sensing elements of one fingertip.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Tactile {
    /// Sequence number of the image from which the forces were computed.
    pub sequence: u64,
    /// Time of that image (s).
    pub stamp: f64,
    /// Force at each element in its frame `E_i` (N): x and y are the tangential force on the feeler by the object, z is
    /// compression, positive when pressed.
    pub forces: Vec<Vector3>,
}

message!(
    Tactile,
    "Tactile",
    "# Tri-axial forces on the sensing elements of one fingertip",
    "uint64 sequence  # of the picture that the forces come from",
    "float64 stamp  # s",
    "geometry_msgs/Vector3[] forces  # N, element frame: x, y tangential on the feeler by the object; z compression",
    vector3_schema!(),
);

/// A tactile frame that was measured between two control steps, if the sensor is faster than the control loop. Together
/// with the [`Tactile`] frames of the steps, these are all frames of the sensor.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileSample {
    /// Sequence number of the image from which the forces were computed.
    pub sequence: u64,
    /// Time of that image (s).
    pub stamp: f64,
    /// Force at each element in its frame `E_i` (N), as in [`Tactile`]; NaN if unknown.
    pub forces: Vec<Vector3>,
}

message!(
    TactileSample,
    "TactileSample",
    "# Forces on one fingertip between two control steps, from a sensor that is faster than the control loop",
    "uint64 sequence  # of the picture that the forces come from",
    "float64 stamp  # s",
    "geometry_msgs/Vector3[] forces  # N, element frame, as in Tactile; NaN if unknown",
    vector3_schema!(),
);

/// Moments of the sensing elements in one image, before calibration.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// Sequence number of the image.
    pub sequence: u64,
    /// Time of the image (s).
    pub stamp: f64,
    /// Integrated grey value of each element, in grey levels times m² (or px² in the image plane).
    pub integrated_gray: Vec<f64>,
    /// Displacement of each centroid from its unloaded position along x (m or px). NaN if unknown.
    pub displacement_x: Vec<f64>,
    /// Displacement of each centroid from its unloaded position along y (m or px). NaN if unknown.
    pub displacement_y: Vec<f64>,
    /// Centroid along x in the element's plane (m) or in the image (px). NaN if the element is dark.
    pub centroid_x: Vec<f64>,
    /// Centroid along y in the element's plane (m) or in the image (px). NaN if the element is dark.
    pub centroid_y: Vec<f64>,
}

message!(
    Moments,
    "Moments",
    "# What one picture says about the sensing elements before any calibration",
    "uint64 sequence  # of the picture",
    "float64 stamp  # s",
    "float64[] integrated_gray  # grey levels times m2 (px2 in the picture's plane)",
    "float64[] displacement_x  # m (px) of the centroid from its unloaded place; NaN where there is none", // words: allow
    "float64[] displacement_y  # m (px)",
    "float64[] centroid_x  # m (px), in the element's plane (in the picture); NaN in the dark",
    "float64[] centroid_y  # m (px)",
);

/// Flags and shear rates computed from one tactile frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Flags {
    /// Time of the tactile frame (s).
    pub stamp: f64,
    /// TOUCH: an element is pressed harder than F1, or SLIP.
    pub touch: bool,
    /// SLIP: an element's shear rate exceeds dr.
    pub slip: bool,
    /// OVER: an element is pressed harder than F2.
    pub over: bool,
    /// Touching element with the largest F_z, or [`NO_ELEMENT`].
    pub largest_element: u32,
    /// Sum of all positive F_z (N).
    pub grasp_force: f64,
    /// |d(F_x, F_y)/dt| of each element (N/s).
    pub shear_rate: Vec<f64>,
}

message!(
    Flags,
    "Flags",
    "# The flag analyzer's view of one tactile frame",
    "float64 stamp  # s",
    "bool touch",
    "bool slip",
    "bool over",
    "uint32 largest_element  # touching element of largest F_z; 4294967295 if none touches",
    "float64 grasp_force  # N, sum of positive F_z",
    "float64[] shear_rate  # N/s, |d(Fx, Fy)/dt| of each element",
);

/// Encoder readings of one finger.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Joints {
    /// Time of the reading (s).
    pub stamp: f64,
    /// Joint positions (rad or m).
    #[serde(with = "joint_array")]
    pub position: JointVector,
    /// Joint velocities (rad/s or m/s).
    #[serde(with = "joint_array")]
    pub velocity: JointVector,
}

message!(
    Joints,
    "Joints",
    "# Encoders of one finger",
    "float64 stamp  # s",
    "float64[3] position  # rad",
    "float64[3] velocity  # rad/s",
);

/// Command to one finger's drives.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Time of the command (s).
    pub stamp: f64,
    /// Joint velocities sent to the drives (rad/s or m/s).
    #[serde(with = "joint_array")]
    pub joint_velocity: JointVector,
    /// Requested fingertip velocity before limiting, in `W` (m/s).
    pub fingertip_velocity: Vector3,
    /// `true` if a limit changed the request.
    pub limited: bool,
    /// Damping of the inverse kinematics near a singularity; otherwise 0.
    pub damping: f64,
}

message!(
    Command,
    "Command",
    "# What the drives of one finger were told", // words: allow
    "float64 stamp  # s",
    "float64[3] joint_velocity  # rad/s, as sent",
    "geometry_msgs/Vector3 fingertip_velocity  # m/s in the world frame, as asked for", // words: allow
    "bool limited  # a limit changed what was asked for", // words: allow
    "float64 damping  # of the inverse near a singularity; 0 away from it",
    vector3_schema!(),
);

/// Pose of one fingertip, computed from encoders and kinematics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fingertip {
    /// Time of the encoder reading (s).
    pub stamp: f64,
    /// Centre of the dome in `W` (m).
    pub position: Vector3,
    /// Orientation of the fingertip frame `T` in `W`.
    pub orientation: Quaternion,
}

message!(
    Fingertip,
    "Fingertip",
    "# Where one fingertip is, from encoders and kinematics",
    "float64 stamp  # s",
    "geometry_msgs/Vector3 position  # m in the world frame, centre of the dome",
    "geometry_msgs/Quaternion orientation  # fingertip frame in the world frame",
    vector3_schema!(),
    quaternion_schema!(),
);

/// Reading of the torque sensor under the bottle.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TorqueSensor {
    /// Time of the sample (s).
    pub stamp: f64,
    /// Torque on the bottle by the cap about the bottle's axis (N·m), as measured through bridge and A/D converter.
    /// Positive when the cap is turned in the closing direction.
    pub torque: f64,
    /// Voltage of the strain-gauge bridge (V).
    pub bridge_voltage: f64,
    /// Counts of the A/D converter.
    pub counts: i32,
}

message!(
    TorqueSensor,
    "TorqueSensor",
    "# Torque between cap and bottle as measured",
    "float64 stamp  # s",
    "float64 torque  # N m, positive when the cap is turned in the closing direction",
    "float64 bridge_voltage  # V",
    "int32 counts  # of the A/D converter",
);

/// True state of the cap. Only known in simulated worlds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Cap {
    /// Time (s).
    pub stamp: f64,
    /// Rotation since the start of the run (rad), positive in the closing direction.
    pub angle: f64,
    /// Height of the cap's centre (m).
    pub height: f64,
    /// Centre of the cap in `W` (m).
    pub centre: Vector3,
    /// True torque between cap and bottle (N·m), positive when it resists closing.
    pub resisting_torque: f64,
}

message!(
    Cap,
    "Cap",
    "# True state of the cap (simulated worlds only)",
    "float64 stamp  # s",
    "float64 angle  # rad turned since the start, positive = closing",
    "float64 height  # m",
    "geometry_msgs/Vector3 centre  # m in the world frame",
    "float64 resisting_torque  # N m between cap and bottle, positive when it resists closing",
    vector3_schema!(),
);

/// True slip of the feelers. Only known in simulated worlds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TrueSlip {
    /// Time (s).
    pub stamp: f64,
    /// For each finger, the longest distance that the anchor of one of its feelers slid on its contact surface since
    /// the previous control step (m).
    pub distance: Vec<f64>,
}

message!(
    TrueSlip,
    "TrueSlip",
    "# How far feelers slipped since the control step before (simulated worlds only)",
    "float64 stamp  # s",
    "float64[] distance  # m, of each finger: the longest way that the anchor of one of its feelers slid",
);

/// State of the task.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Time of the control step (s).
    pub stamp: f64,
    /// Phase to which the step's command belongs.
    pub phase: Phase,
    /// Number of the stroke, from 1; 0 before the first.
    pub stroke: u32,
    /// Reason for entering the phase.
    pub reason: String,
}

message!(
    Task,
    "Task",
    "# Where the task stands",
    "uint8 SEARCH=0",
    "uint8 MOVE=1",
    "uint8 RELEASE=2",
    "uint8 RETURN=3",
    "uint8 DONE=4",
    "uint8 STOPPED=5",
    "float64 stamp  # s",
    "uint8 phase",
    "uint32 stroke  # from 1; 0 before the first",
    "string reason  # why the phase was entered",
);

/// Findings of the task so far. Written when they change.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Time of the control step (s).
    pub stamp: f64,
    /// Outcome of the task, or `None` while undetermined, which is an empty text on the wire.
    #[serde(with = "optional_text")]
    pub outcome: Option<TaskOutcome>,
    /// Names of the findings.
    pub names: Vec<FindingName>,
    /// Values of the findings, in SI units.
    pub values: Vec<f64>,
}

impl Findings {
    /// Value of a finding in SI units, or `None` if it was not found.
    pub fn value(&self, name: &FindingName) -> Option<f64> {
        let place = self.names.iter().position(|n| n == name)?;
        self.values.get(place).copied()
    }
}

message!(
    Findings,
    "Findings",
    "# What the task found out so far; sent when that changes",
    "float64 stamp  # s",
    "string outcome  # in a few words; empty until the task can tell",
    "string[] names",
    "float64[] values  # SI units",
);

/// Serializes `None` as an empty text, because ROS 2 has no optional fields.
mod optional_text {
    use super::TaskOutcome;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(
        outcome: &Option<TaskOutcome>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(outcome.as_ref().map_or("", TaskOutcome::as_str))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<TaskOutcome>, D::Error> {
        let text = String::deserialize(deserializer)?;
        Ok((!text.is_empty()).then(|| text.into()))
    }
}

/// True pose of the carried object. Only known in simulated worlds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectPose {
    /// Time (s).
    pub stamp: f64,
    /// Origin of its frame in `W` (m).
    pub position: Vector3,
    /// Orientation of its frame in `W`.
    pub orientation: Quaternion,
}

message!(
    ObjectPose,
    "ObjectPose",
    "# True pose of the object that is carried (simulated worlds only)",
    "float64 stamp  # s",
    "geometry_msgs/Vector3 position  # m in the world frame",
    "geometry_msgs/Quaternion orientation  # of its frame in the world frame",
    vector3_schema!(),
    quaternion_schema!(),
);

/// Messages dropped at this position because the file accepted no data. A complete recording has no such channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordingGap {
    /// Time of the first missing message (s).
    pub start: f64,
    /// Time of the last missing message (s).
    pub end: f64,
    /// Number of missing messages.
    pub messages: u64,
}

message!(
    RecordingGap,
    "RecordingGap",
    "# Messages that are missing from here on: the file took nothing while they were written",
    "float64 start  # s, of the first message that is missing",
    "float64 end  # s, of the last",
    "uint64 messages  # that are missing",
);

impl Stamped for RecordingGap {
    fn stamp(&self) -> f64 {
        self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_are_rounded_and_invalid_times_are_none() {
        for ns in [0_u64, 1, 999_999_999, 18_540_000_000, 1 << 53] {
            for share in [-0.49, 0.0, 0.25, 0.49] {
                let stamp = (ns as f64 + share) * 1e-9;
                // Of the same product, which may differ from the exact value.
                assert_eq!(
                    nanoseconds(stamp),
                    Some((stamp * 1e9).round() as u64),
                    "{stamp}"
                );
            }
        }
        assert_eq!(nanoseconds(2.5e-9), Some(3));
        assert_eq!(nanoseconds(-0.0), Some(0));
        for stamp in [-1e-9, -1.0, 1e11, f64::NAN, f64::INFINITY] {
            assert_eq!(nanoseconds(stamp), None, "{stamp}");
        }
    }
}
