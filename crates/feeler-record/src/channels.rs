//! What a recording holds: one plain struct per message, each with its ROS 2 message text.
//!
//! The order of a struct's fields is the order of its schema's lines; both are the wire format.
//! All stamps are seconds of the run's time (simulated or real), not of the wall clock.

use super::names::{FindingName, TaskOutcome};
use crate::wire::{Message, Quaternion, Vector3, message, quaternion_schema, vector3_schema};
use feeler::control::phase::Phase;
use serde::{Deserialize, Serialize};

/// [`Flags::largest_element`] when no element touches.
pub const NO_ELEMENT: u32 = u32::MAX;

/// A message that a recording can hold.
pub trait Stamped: Message {
    /// Time of the message, s.
    fn stamp(&self) -> f64;
}

/// A stamp in whole nanoseconds; none if it is no time of a run.
pub(crate) fn nanoseconds(stamp: f64) -> Option<u64> {
    let ns = stamp * 1e9;
    if !(ns > -0.5 && ns < u64::MAX as f64) {
        return None;
    }
    // Rounded here: elsewhere than in the newest processors, `round` is a call of the system's library.
    let below = ns as u64;
    Some(below + u64::from(ns - below as f64 >= 0.5))
}

/// Implements [`Stamped`] for structs with a `stamp`.
macro_rules! stamped {
    ($($type:ident),+ $(,)?) => {
        $(impl Stamped for $type {
            fn stamp(&self) -> f64 {
                self.stamp
            }
        })+
    };
}

stamped!(
    Tactile,
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

/// One fingertip's tri-axial forces.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Tactile {
    /// Sequence number of the picture that the forces come from.
    pub sequence: u64,
    /// Time of that picture, s.
    pub stamp: f64,
    /// Force at each element in its frame `E_i`, N: x, y tangential on the feeler by the object,
    /// z compression, positive when pressed.
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

/// What one picture says about the sensing elements before any calibration.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// Sequence number of the picture.
    pub sequence: u64,
    /// Time of the picture, s.
    pub stamp: f64,
    /// Integrated gray value of each element, grey levels times m² (px² in the picture's plane).
    pub integrated_gray: Vec<f64>,
    /// Displacement of each centroid along x from its unloaded place, m (px); NaN where there is none.
    pub displacement_x: Vec<f64>,
    /// The same along y.
    pub displacement_y: Vec<f64>,
    /// Centroid along x in the element's plane (in the picture), m (px); NaN in the dark.
    pub centroid_x: Vec<f64>,
    /// The same along y.
    pub centroid_y: Vec<f64>,
}

message!(
    Moments,
    "Moments",
    "# What one picture says about the sensing elements before any calibration",
    "uint64 sequence  # of the picture",
    "float64 stamp  # s",
    "float64[] integrated_gray  # grey levels times m2 (px2 in the picture's plane)",
    "float64[] displacement_x  # m (px) of the centroid from its unloaded place; NaN where there is none",
    "float64[] displacement_y  # m (px)",
    "float64[] centroid_x  # m (px), in the element's plane (in the picture); NaN in the dark",
    "float64[] centroid_y  # m (px)",
);

/// What the flag analyzer makes of one tactile frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Flags {
    /// Time of the tactile frame, s.
    pub stamp: f64,
    /// TOUCH: an element is pressed harder than F1, or SLIP.
    pub touch: bool,
    /// SLIP: an element's shear rate exceeds dr.
    pub slip: bool,
    /// OVER: an element is pressed harder than F2.
    pub over: bool,
    /// The touching element of largest F_z, or [`NO_ELEMENT`].
    pub largest_element: u32,
    /// Sum of the positive F_z, N.
    pub grasp_force: f64,
    /// |d(F_x, F_y)/dt| of each element, N/s.
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

/// One finger's encoders.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Joints {
    /// Time of the reading, s.
    pub stamp: f64,
    /// Joint angles theta1..theta3, rad.
    pub position: [f64; 3],
    /// Joint velocities, rad/s.
    pub velocity: [f64; 3],
}

message!(
    Joints,
    "Joints",
    "# Encoders of one finger",
    "float64 stamp  # s",
    "float64[3] position  # rad",
    "float64[3] velocity  # rad/s",
);

/// What one finger's drives were told.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Time of the command, s.
    pub stamp: f64,
    /// Joint velocities as sent, rad/s.
    pub joint_velocity: [f64; 3],
    /// Fingertip velocity as asked for, before any limit, m/s in `W`.
    pub fingertip_velocity: Vector3,
    /// Whether a limit changed what was asked for.
    pub limited: bool,
    /// Damping of the inverse near a singularity; 0 away from it.
    pub damping: f64,
}

message!(
    Command,
    "Command",
    "# What the drives of one finger were told",
    "float64 stamp  # s",
    "float64[3] joint_velocity  # rad/s, as sent",
    "geometry_msgs/Vector3 fingertip_velocity  # m/s in the world frame, as asked for",
    "bool limited  # a limit changed what was asked for",
    "float64 damping  # of the inverse near a singularity; 0 away from it",
    vector3_schema!(),
);

/// Where one fingertip is, from encoders and kinematics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fingertip {
    /// Time of the encoder reading, s.
    pub stamp: f64,
    /// Centre of the dome, m in `W`.
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

/// What the torque sensor under the bottle measures.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TorqueSensor {
    /// Time of the sample, s.
    pub stamp: f64,
    /// Torque on the bottle by the cap about the bottle's axis, N·m, as measured through bridge
    /// and A/D converter; positive when the cap is turned in the closing direction.
    pub torque: f64,
    /// Voltage of the strain gauges' bridge, V.
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

/// The cap's true state; only a simulated world knows it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Cap {
    /// Time, s.
    pub stamp: f64,
    /// Angle the cap has turned since the run's start, rad, positive = closing.
    pub angle: f64,
    /// Height of the cap's centre, m.
    pub height: f64,
    /// The cap's centre, m in `W`.
    pub centre: Vector3,
    /// True torque between cap and bottle, N·m, positive when it resists closing.
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

/// How far feelers have slipped; only a simulated world knows it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TrueSlip {
    /// Time, s.
    pub stamp: f64,
    /// Of each finger's feelers, the longest way that an anchor slid over what it touches since the control
    /// step before, m.
    pub distance: Vec<f64>,
}

message!(
    TrueSlip,
    "TrueSlip",
    "# How far feelers slipped since the control step before (simulated worlds only)",
    "float64 stamp  # s",
    "float64[] distance  # m, of each finger: the longest way that the anchor of one of its feelers slid",
);

/// Where the task stands.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Time of the control step, s.
    pub stamp: f64,
    /// Phase that the step's command belongs to.
    pub phase: Phase,
    /// Number of the stroke from 1; 0 before the first.
    pub stroke: u32,
    /// Why the phase was entered, in words.
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

/// What the task found out so far; written when that changes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Time of the control step, s.
    pub stamp: f64,
    /// What came of the task; none until it can tell. Its text on the wire, which is empty where there is none.
    #[serde(with = "optional_text")]
    pub outcome: Option<TaskOutcome>,
    /// What each finding is.
    pub names: Vec<FindingName>,
    /// The value of each, in SI units.
    pub values: Vec<f64>,
}

impl Findings {
    /// The value of a finding, in SI units, if it was found.
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

/// A text that is empty where there is none, as ROS 2 has no optional fields.
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

/// Where the object is that is carried; only a simulated world knows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectPose {
    /// Time, s.
    pub stamp: f64,
    /// Its origin, m in `W`.
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

/// Messages that are missing from here on, as the file took nothing while they were written. It stands where they
/// would; a recording of which nothing is missing has no such channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordingGap {
    /// Time of the first message that is missing, s.
    pub start: f64,
    /// Time of the last message that is missing, s.
    pub end: f64,
    /// Messages that are missing.
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
    fn nanoseconds_are_the_nearest_and_none_of_what_is_no_time() {
        for ns in [0_u64, 1, 999_999_999, 18_540_000_000, 1 << 53] {
            for share in [-0.49, 0.0, 0.25, 0.49] {
                let stamp = (ns as f64 + share) * 1e-9;
                // Of the same product, which need not be what was meant.
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
