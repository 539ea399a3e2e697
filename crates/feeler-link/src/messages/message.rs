//! Messages between the programs: one plain struct per message, each with its ROS 2 message definition.
//!
//! Stamps are in seconds on the clock of the program given by `MessageHeader::clock`. With simulated cameras, that is
//! the world program.

use super::freshness::Echo;
use super::printable::printable;
use crate::transport::topic::Place;
use feeler::control::Phase;
use feeler::hand::MAX_FINGERS;
use feeler_record::text_enum;
use feeler_record::wire::{Quaternion, Vector3, message, quaternion_schema, vector3_schema};
use serde::{Deserialize, Serialize};

/// Version of these messages. A program rejects and reports messages of any other version.
pub const PROTOCOL: u32 = 4;

/// Value of [`TactileUpdate::largest_element`] if no element touches.
pub const NO_ELEMENT: u32 = u32::MAX;

/// Value of [`Heartbeat::finger`] for a program that does not belong to a single finger.
pub const NO_FINGER: u32 = u32::MAX;

/// Value of [`StopInForce::id`] if the sender drew no number.
pub const NO_ID: u64 = u64::MAX;

/// Message header: sender, sequence number, stamp, and an echo of the hand's latest step that bounds the data's age.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct MessageHeader {
    /// Protocol version: [`PROTOCOL`].
    pub protocol: u32,
    /// Random number that the sending program drew at its start.
    pub instance: u64,
    /// Instance of the program whose clock `stamp` refers to.
    pub clock: u64,
    /// Sequence number among messages of the same kind.
    pub sequence: u64,
    /// Time at which the content was measured or computed (s).
    pub stamp: f64,
    /// Latest control step of the hand that had arrived by `stamp`, or 0 if none.
    pub echo_step: u64,
    /// The hand's token for that step ([`HandMode::token`]).
    pub echo_token: u64,
    /// Age of that step at the measurement, since its arrival (s).
    pub echo_age: f64,
}

impl MessageHeader {
    /// Returns the sender's instance and the sequence number.
    pub(crate) fn number(&self) -> (u64, u64) {
        (self.instance, self.sequence)
    }

    /// Returns this header with the echo fields set for data taken at `time` (s), when `echo` was the latest step
    /// received from the hand.
    pub fn echoing(self, echo: Echo, time: f64) -> Self {
        Self {
            echo_step: echo.step,
            echo_token: echo.token,
            echo_age: time - echo.arrived,
            ..self
        }
    }
}

/// Definition of [`MessageHeader`], appended to each schema that uses it.
macro_rules! header_schema {
    () => {
        "================================================================================\n\
         MSG: feeler_msgs/Header\n\
         uint32 protocol  # version of the messages\n\
         uint64 instance  # of the sending program\n\
         uint64 clock  # instance of the program whose clock the stamp is of\n\
         uint64 sequence  # among messages of this kind\n\
         float64 stamp  # s\n\
         uint64 echo_step  # control step of the hand's newest message at that time; 0: none\n\
         uint64 echo_token  # the hand's token of that step\n\
         float64 echo_age  # s before that time at which it had arrived"
    };
}

/// Tactile frame of one finger with its flags, computed by the sensor program from one image.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileUpdate {
    /// Sender, stamp and echo.
    pub header: MessageHeader,
    /// Finger index, from 0.
    pub finger: u32,
    /// Frame sequence number; repeated if the camera delivered no new image.
    pub frame: u64,
    /// TOUCH: an element's F_z is above F1, or SLIP.
    pub touch: bool,
    /// SLIP: an element's shear rate is above dr.
    pub slip: bool,
    /// OVER: an element's F_z is above F2.
    pub over: bool,
    /// Touching element with the largest F_z, or [`NO_ELEMENT`].
    pub largest_element: u32,
    /// Sum of the positive F_z (N).
    pub grasp_force: f64,
    /// Force on each element in its frame `E_i` (N): x and y are the tangential force on the feeler by the object, z is
    /// compression, positive when pressed.
    pub forces: Vec<Vector3>,
    /// Shear rate |d(F_x, F_y)/dt| of each element (N/s).
    pub shear_rate: Vec<f64>,
    /// Mask of slipping elements: bit `i % 8` of byte `i / 8` is element `i`.
    #[serde(with = "serde_bytes")]
    pub slip_mask: Vec<u8>,
    /// Bit mask of the elements without a valid force (dark or saturated), laid out like `slip_mask`. Their forces are 0 N.
    #[serde(with = "serde_bytes")]
    pub invalid_mask: Vec<u8>,
}

message!(
    TactileUpdate,
    "TactileUpdate",
    "# What one finger feels",
    "feeler_msgs/Header header",
    "uint32 finger  # from 0",
    "uint64 frame  # number of the picture; the same again where there was none new",
    "bool touch",
    "bool slip",
    "bool over",
    "uint32 largest_element  # touching element of largest F_z; 4294967295 if none touches",
    "float64 grasp_force  # N, sum of positive F_z",
    "geometry_msgs/Vector3[] forces  # N, element frame: x, y tangential on the feeler by the object; z compression",
    "float64[] shear_rate  # N/s, |d(Fx, Fy)/dt| of each element",
    "uint8[] slip_mask  # bit i % 8 of byte i / 8: element i slips",
    "uint8[] invalid_mask  # the same: element i has no valid force",
    header_schema!(),
    vector3_schema!(),
);

/// Camera image of one finger, from a rig whose cameras are not on the sensor computer.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PictureMessage {
    /// Sender, stamp and echo.
    pub header: MessageHeader,
    /// Finger index, from 0.
    pub finger: u32,
    /// Frame sequence number; repeated if the camera delivered no new image.
    pub frame: u64,
    /// Width (px).
    pub width: u32,
    /// Height (px).
    pub height: u32,
    /// Gray values, row by row from the top left.
    #[serde(with = "serde_bytes")]
    pub pixels: Vec<u8>,
}

message!(
    PictureMessage,
    "Picture",
    "# What one finger's camera sees",
    "feeler_msgs/Header header",
    "uint32 finger  # from 0",
    "uint64 frame  # number of the picture; the same again where there was none new",
    "uint32 width  # px",
    "uint32 height  # px",
    "uint8[] pixels  # grey, row by row from the top left",
    header_schema!(),
);

/// Forces on one finger's elements, from a simulated rig that renders no images.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct DirectForces {
    /// Sender, stamp and echo.
    pub header: MessageHeader,
    /// Finger index, from 0.
    pub finger: u32,
    /// Frame sequence number; repeated if the camera delivered no new image.
    pub frame: u64,
    /// Force on each element (N), as in [`TactileUpdate::forces`].
    pub forces: Vec<Vector3>,
}

message!(
    DirectForces,
    "DirectForces",
    "# What one finger's feelers feel, without pictures",
    "feeler_msgs/Header header",
    "uint32 finger  # from 0",
    "uint64 frame  # number of the picture; the same again where there was none new",
    "geometry_msgs/Vector3[] forces  # N, element frame: x, y tangential on the feeler by the object; z compression",
    header_schema!(),
    vector3_schema!(),
);

/// State of the hand, sent once per control step. `MessageHeader::sequence` is the step, from 1.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct HandMode {
    /// Sender and stamp; the echo is empty.
    pub header: MessageHeader,
    /// Unpredictable number of this step. A program that echoes it has received the step.
    pub token: u64,
    /// SEARCH: the fingers approach the object.
    pub search: bool,
    /// MOVE: the fingers move the object.
    pub r#move: bool,
    /// Phase of the task, numbered as in [`feeler::control::Phase`].
    pub phase: u8,
    /// Stroke number, from 1.
    pub stroke: u32,
    /// Reason of the stop; empty if the hand is not stopped.
    pub stopped: String,
    /// Active stops, oldest first. The hand resumes once each of them has been resumed.
    pub stops: Vec<StopInForce>,
}

/// Active stop of the hand, not resumed yet.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StopInForce {
    /// Number that a resume order must contain.
    pub number: u64,
    /// [`StopMessage::id`] of the order, [`NO_ID`] if its sender drew none, or 0 if the hand stopped itself.
    pub id: u64,
    /// Sender of the order, or the reason if the hand stopped itself.
    pub by: String,
}

impl HandMode {
    /// Returns `true` if the hand has not started because its rig is incomplete.
    pub fn is_waiting(&self) -> bool {
        // Once started, a hand in SEARCH also sets the `search` flag.
        self.phase == u8::from(Phase::Search) && !self.search
    }

    /// Escapes control characters in all texts and limits their length, see `printable`.
    pub fn make_printable(&mut self) {
        self.stopped = printable(&self.stopped);
        for stop in &mut self.stops {
            stop.by = printable(&stop.by);
        }
    }
}

message!(
    HandMode,
    "HandMode",
    "# What the hand is about; header.sequence is the control step",
    "uint8 SEARCH=0",
    "uint8 MOVE=1",
    "uint8 RELEASE=2",
    "uint8 RETURN=3",
    "uint8 DONE=4",
    "uint8 STOPPED=5",
    "feeler_msgs/Header header",
    "uint64 token  # nobody can guess it before this step", // words: allow
    "bool search",
    "bool move",
    "uint8 phase",
    "uint32 stroke  # from 1",
    "string stopped  # why the hand is stopped; empty when it is not",
    "feeler_msgs/StopInForce[] stops  # that have not been resumed, the oldest first",
    header_schema!(),
    "================================================================================",
    "MSG: feeler_msgs/StopInForce",
    "uint64 number  # by which it is resumed",
    "uint64 id  # of the order, 18446744073709551615 where none was drawn; 0 where the hand stopped by itself",
    "string by  # who ordered it, or why the hand stopped by itself",
);

/// Command to the drives, valid until the next one or until the rig's watchdog expires. `MessageHeader::sequence` is
/// the control step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CommandMessage {
    /// Sender and stamp. Stamp and clock are the rig's, of the oldest data that the command is based on.
    pub header: MessageHeader,
    /// Token of the step, as in [`HandMode::token`].
    pub token: u64,
    /// Sequence number of the [`StateMessage`] that the command is based on.
    pub state_sequence: u64,
    /// Velocities of joints theta1..theta3 of each finger (rad/s).
    pub joint_velocity: Vec<Vector3>,
}

message!(
    CommandMessage,
    "HandCommand",
    "# What the drives are to do; header.sequence is the control step",
    "feeler_msgs/Header header  # stamp and clock: the rig's, of the oldest data that it was made from",
    "uint64 token  # nobody can guess it before this step", // words: allow
    "uint64 state_sequence  # of the HandState that it was made from",
    "geometry_msgs/Vector3[] joint_velocity  # rad/s, theta1..theta3 of each finger",
    header_schema!(),
    vector3_schema!(),
);

/// Encoder readings, and the rig's instruments if it has any.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StateMessage {
    /// Sender, stamp and echo.
    pub header: MessageHeader,
    /// Joint angles theta1..theta3 of each finger (rad).
    pub position: Vec<Vector3>,
    /// Joint velocities of each finger (rad/s).
    pub velocity: Vec<Vector3>,
    /// Instruments: empty or one entry.
    pub instruments: Vec<InstrumentsMessage>,
}

message!(
    StateMessage,
    "HandState",
    "# What the encoders say",
    "feeler_msgs/Header header",
    "geometry_msgs/Vector3[] position  # rad, theta1..theta3 of each finger",
    "geometry_msgs/Vector3[] velocity  # rad/s",
    "feeler_msgs/Instruments[] instruments  # none or one",
    header_schema!(),
    vector3_schema!(),
    "================================================================================",
    "MSG: feeler_msgs/Instruments",
    "float64 torque  # N m between cap and bottle, positive when the cap is turned in the closing direction",
    "float64 bridge_voltage  # V",
    "int32 counts  # of the A/D converter",
    "float64 cap_angle  # rad turned since the start, positive = closing (simulated worlds only)",
    "geometry_msgs/Vector3 cap_centre  # m in the world frame (simulated worlds only)",
    "float64 cap_torque  # N m, true, positive when it resists closing (simulated worlds only)",
    "float64[5] slipped  # m, of each finger: how far a feeler slipped since the state before (simulated worlds only)",
    "bool has_object  # whether an object is carried of which it is known where it is (simulated worlds only)", // words: allow
    "geometry_msgs/Vector3 object_position  # m, its origin in the world frame",
    "geometry_msgs/Quaternion object_orientation  # of its frame in the world frame",
    quaternion_schema!(),
);

/// Readings of the rig's instruments, and ground truth of the cap from a simulated world.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct InstrumentsMessage {
    /// Measured torque between cap and bottle (N·m), positive when turned in the closing direction.
    pub torque: f64,
    /// Voltage of the strain-gauge bridge (V).
    pub bridge_voltage: f64,
    /// A/D converter counts.
    pub counts: i32,
    /// Rotation of the cap since the start (rad), positive in the closing direction.
    pub cap_angle: f64,
    /// Centre of the cap in `W` (m).
    pub cap_centre: Vector3,
    /// True torque between cap and bottle (N·m), positive when it resists closing.
    pub cap_torque: f64,
    /// Largest distance that a contact anchor of each finger slid since the previous state (m).
    pub slipped: [f64; MAX_FINGERS],
    /// `true` if the rig contains a carried object with known pose.
    pub has_object: bool,
    /// Origin of the object in `W` (m).
    pub object_position: Vector3,
    /// Orientation of the object's frame in `W`.
    pub object_orientation: Quaternion,
}

text_enum! {
    /// Kind of a program in a rig.
    ProgramKind {
        /// Sensor program of one finger.
        Sense = "sense",
        /// Hand program, which controls the fingers.
        Hand = "hand",
        /// World program, which simulates or serves the rig.
        World = "world",
        /// Program that sends one order to the hand and exits.
        Order = "order",
    }
}

impl Default for ProgramKind {
    fn default() -> Self {
        Self::Other(String::new())
    }
}

/// Announces a program, its configuration and its health. Sent ten times per second.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Heartbeat {
    /// Protocol version. This is the first field in every version.
    pub protocol: u32,
    /// Random number that the program drew at its start.
    pub instance: u64,
    /// Kind of the program.
    pub program: ProgramKind,
    /// Version of feeler.
    pub version: String,
    /// Finger index from 0, or [`NO_FINGER`].
    pub finger: u32,
    /// SHA-256 of the program's experiment.
    pub experiment: String,
    /// SHA-256 of the fingertip that the program senses with; empty if it does not sense.
    pub fingertip: String,
    /// Sequence number of the heartbeat.
    pub sequence: u64,
    /// Rate of frames, control steps or camera steps of the world (1/s).
    pub rate: f64,
    /// Age of the latest data used (s), or NaN if none was used.
    pub age: f64,
    /// Number of lost messages, from gaps in sequence numbers.
    pub lost: u64,
    /// Number of rejected messages.
    pub refused: u64,
    /// Number of missed periods.
    pub missed: u64,
    /// Ratio of experiment time to real time, or 0 in lockstep.
    pub speed: f64,
    /// Latest fault; empty if none occurred.
    pub fault: String,
}

impl Heartbeat {
    /// Returns the program's place in the rig, or `None` if kind and finger do not match any.
    pub fn place(&self) -> Option<Place> {
        match (&self.program, self.finger) {
            (ProgramKind::Hand, NO_FINGER) => Some(Place::Hand),
            (ProgramKind::World, NO_FINGER) => Some(Place::World),
            (ProgramKind::Order, NO_FINGER) => Some(Place::Order),
            (ProgramKind::Sense, finger) => Some(Place::Sense(usize::try_from(finger).ok()?)),
            _ => None,
        }
    }
}

message!(
    Heartbeat,
    "Heartbeat",
    "# That a program is there, what it is, and how it does",
    "uint32 protocol  # version of the messages",
    "uint64 instance  # of the program",
    "string program  # sense, hand, world or another",
    "string version  # of feeler",
    "uint32 finger  # from 0; 4294967295 if it is not one finger's",
    "string experiment  # SHA-256",
    "string fingertip  # SHA-256; empty where it senses nothing",
    "uint64 sequence",
    "float64 rate  # 1/s: frames, control steps, steps of the cameras",
    "float64 age  # s, of the newest data it has used; NaN for none",
    "uint64 lost  # messages missed",
    "uint64 refused  # messages refused",
    "uint64 missed  # periods missed",
    "float64 speed  # seconds of the experiment in a second; 0 where programs wait for each other",
    "string fault  # what last went wrong; empty for nothing",
);

/// Order to stop the hand.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StopMessage {
    /// Protocol version.
    pub protocol: u32,
    /// Name of the sender for display and recording, truncated to 256 bytes.
    pub from: String,
    /// Random number drawn by the sender. Messages with the same number repeat one stop. 0 if none was drawn; then all
    /// stops from the same sender count as one.
    pub id: u64,
}

message!(
    StopMessage,
    "Stop",
    "# Stops the hand, whoever sends it", // words: allow
    "uint32 protocol  # version of the messages",
    "string from  # who says so", // words: allow
    "uint64 id  # that the sender draws: the same again is the same stop; 0 for none",
);

/// Order to resume from a stop. The hand moves again once each active stop has been resumed and its cause is gone.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ResumeMessage {
    /// Protocol version.
    pub protocol: u32,
    /// Name of the sender for display and recording.
    pub from: String,
    /// Number of the stop: [`StopInForce::number`].
    pub number: u64,
}

message!(
    ResumeMessage,
    "Resume",
    "# Resumes a stop; the hand goes on when each stop in force has been resumed", // words: allow
    "uint32 protocol  # version of the messages",
    "string from  # who says so", // words: allow
    "uint64 number  # of the stop, in HandMode.stops",
);
