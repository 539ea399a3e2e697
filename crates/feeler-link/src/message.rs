//! What the programs say to each other: one plain struct per message, each with its ROS 2 message text.
//!
//! All stamps are seconds on the clock of the program that `MessageHeader::clock` names: in a system with
//! simulated cameras, that of the world.

use super::freshness::Echo;
use super::printable::printable;
use super::topic::Place;
use feeler::control::phase::Phase;
use feeler::hand::MAX_FINGERS;
use feeler_record::text_enum;
use feeler_record::wire::{Quaternion, Vector3, message, quaternion_schema, vector3_schema};
use serde::{Deserialize, Serialize};

/// Version of these messages. A program takes no other, and says so.
pub const PROTOCOL: u32 = 4;

/// [`TactileUpdate::largest_element`] when no element touches.
pub const NO_ELEMENT: u32 = u32::MAX;

/// [`Heartbeat::finger`] of a program that is not one finger's.
pub const NO_FINGER: u32 = u32::MAX;

/// [`StopInForce::id`] of an order whose sender drew none.
pub const NO_ID: u64 = u64::MAX;

/// Who sends, what came before, and how fresh it is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct MessageHeader {
    /// Version of the messages: [`PROTOCOL`].
    pub protocol: u32,
    /// The sending program, by a number that it drew when it started.
    pub instance: u64,
    /// The program whose clock the stamp is of, by its instance.
    pub clock: u64,
    /// Number of the message among those of its kind.
    pub sequence: u64,
    /// Time of what the message tells, s.
    pub stamp: f64,
    /// Control step of the newest message of the hand that had arrived at that time; 0: none had.
    pub echo_step: u64,
    /// The hand's token of that step ([`HandMode::token`]).
    pub echo_token: u64,
    /// How long before that time it had arrived, s.
    pub echo_age: f64,
}

impl MessageHeader {
    /// The same of what was taken at `time` (s), when `echo` was the newest of the hand that had arrived.
    pub fn echoing(self, echo: Echo, time: f64) -> Self {
        Self {
            echo_step: echo.step,
            echo_token: echo.token,
            echo_age: time - echo.arrived,
            ..self
        }
    }
}

/// The text of [`MessageHeader`], to stand after a schema that uses it.
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

/// What one finger feels: one picture through the sensor program.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileUpdate {
    /// Who, when, how fresh.
    pub header: MessageHeader,
    /// The finger, from 0.
    pub finger: u32,
    /// Number of the picture; the same again where the camera delivered nothing new.
    pub frame: u64,
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
    /// Force at each element in its frame `E_i`, N: x, y tangential on the feeler by the object,
    /// z compression, positive when pressed.
    pub forces: Vec<Vector3>,
    /// |d(F_x, F_y)/dt| of each element, N/s.
    pub shear_rate: Vec<f64>,
    /// Which elements slip: bit `i % 8` of byte `i / 8` is element `i`.
    #[serde(with = "serde_bytes")]
    pub slip_mask: Vec<u8>,
    /// Which elements have no valid force (dark or saturated), in the same way; theirs are 0 N.
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

/// What one finger's camera sees; from a rig whose cameras are not on the sensor computer.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PictureMessage {
    /// Who, when, how fresh.
    pub header: MessageHeader,
    /// The finger, from 0.
    pub finger: u32,
    /// Number of the picture; the same again where the camera delivered nothing new.
    pub frame: u64,
    /// Columns, px.
    pub width: u32,
    /// Rows, px.
    pub height: u32,
    /// Grey values, row by row from the top left.
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

/// What one finger's feelers feel, from a simulated rig without pictures.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct DirectForces {
    /// Who, when, how fresh.
    pub header: MessageHeader,
    /// The finger, from 0.
    pub finger: u32,
    /// Number of the picture; the same again where the camera delivered nothing new.
    pub frame: u64,
    /// Force at each element as in [`TactileUpdate::forces`], N.
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

/// What the hand is about, once each control step. `MessageHeader::sequence` is the step, from 1.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct HandMode {
    /// Who and when; it echoes nothing.
    pub header: MessageHeader,
    /// Number that nobody can guess before this step: who echoes it has heard of the step.
    pub token: u64,
    /// SEARCH: the fingers approach the object.
    pub search: bool,
    /// MOVE: the fingers move the object.
    pub r#move: bool,
    /// Phase of the task, as [`feeler::control::phase::Phase`] numbers them.
    pub phase: u8,
    /// Number of the stroke from 1.
    pub stroke: u32,
    /// Why the hand is stopped; empty when it is not.
    pub stopped: String,
    /// The stops that are in force, the oldest first. The hand goes on when each has been resumed.
    pub stops: Vec<StopInForce>,
}

/// A stop of the hand that has not been resumed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StopInForce {
    /// Its number, by which it is resumed.
    pub number: u64,
    /// [`StopMessage::id`] of the order, [`NO_ID`] where its sender drew none; 0 where the hand stopped by itself.
    pub id: u64,
    /// Who ordered it, or why the hand stopped by itself.
    pub by: String,
}

impl HandMode {
    /// Whether the hand has not begun: its rig is not whole yet.
    pub fn is_waiting(&self) -> bool {
        // A hand at work is in a phase, and says so by flag where that is SEARCH.
        self.phase == u8::from(Phase::Search) && !self.search
    }

    /// Makes its texts fit for a screen.
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
    "uint64 token  # nobody can guess it before this step",
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

/// What the drives are to do until the next one, but no longer than the rig's watchdog allows.
/// `MessageHeader::sequence` is the control step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CommandMessage {
    /// Who and when; stamp and clock are the rig's, of the oldest data that it was made from.
    pub header: MessageHeader,
    /// As [`HandMode::token`].
    pub token: u64,
    /// Sequence number of the [`StateMessage`] that it was made from.
    pub state_sequence: u64,
    /// Joint velocities theta1..theta3 of each finger, rad/s.
    pub joint_velocity: Vec<Vector3>,
}

message!(
    CommandMessage,
    "HandCommand",
    "# What the drives are to do; header.sequence is the control step",
    "feeler_msgs/Header header  # stamp and clock: the rig's, of the oldest data that it was made from",
    "uint64 token  # nobody can guess it before this step",
    "uint64 state_sequence  # of the HandState that it was made from",
    "geometry_msgs/Vector3[] joint_velocity  # rad/s, theta1..theta3 of each finger",
    header_schema!(),
    vector3_schema!(),
);

/// What the encoders say, and the rig's instruments where it has any.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StateMessage {
    /// Who, when, how fresh.
    pub header: MessageHeader,
    /// Joint angles theta1..theta3 of each finger, rad.
    pub position: Vec<Vector3>,
    /// Joint velocities of each finger, rad/s.
    pub velocity: Vec<Vector3>,
    /// The instruments; none or one.
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
    "bool has_object  # whether an object is carried of which it is known where it is (simulated worlds only)",
    "geometry_msgs/Vector3 object_position  # m, its origin in the world frame",
    "geometry_msgs/Quaternion object_orientation  # of its frame in the world frame",
    quaternion_schema!(),
);

/// What the rig's own instruments say, and what only a simulated world knows of its cap.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct InstrumentsMessage {
    /// Torque between cap and bottle as measured, N·m, positive when turned in the closing direction.
    pub torque: f64,
    /// Voltage of the strain gauges' bridge, V.
    pub bridge_voltage: f64,
    /// Counts of the A/D converter.
    pub counts: i32,
    /// Angle the cap has turned since the start, rad, positive = closing.
    pub cap_angle: f64,
    /// The cap's centre, m in `W`.
    pub cap_centre: Vector3,
    /// True torque between cap and bottle, N·m, positive when it resists closing.
    pub cap_torque: f64,
    /// Of each finger's feelers, the longest way that an anchor slid since the state before, m.
    pub slipped: [f64; MAX_FINGERS],
    /// Whether an object is carried of which it is known where it is.
    pub has_object: bool,
    /// Its origin, m in `W`.
    pub object_position: Vector3,
    /// Orientation of its frame in `W`.
    pub object_orientation: Quaternion,
}

text_enum! {
    /// What a program of a rig is.
    ProgramKind {
        /// Senses for one finger.
        Sense = "sense",
        /// Controls the hand.
        Hand = "hand",
        /// Plays the rig.
        World = "world",
        /// Sends one order to the hand, and ends.
        Order = "order",
    }
}

impl Default for ProgramKind {
    fn default() -> Self {
        Self::Other(String::new())
    }
}

/// That a program is there, what it is, and how it does. Sent ten times a second.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Heartbeat {
    /// Version of the messages. It stands first in every version.
    pub protocol: u32,
    /// The program, by a number that it drew when it started.
    pub instance: u64,
    /// What it is.
    pub program: ProgramKind,
    /// Version of feeler that it is.
    pub version: String,
    /// The finger it is of, from 0, or [`NO_FINGER`].
    pub finger: u32,
    /// SHA-256 of the experiment that it works by.
    pub experiment: String,
    /// SHA-256 of the fingertip that it senses by; empty where it senses nothing.
    pub fingertip: String,
    /// Number of the heartbeat.
    pub sequence: u64,
    /// What it does a second: frames, control steps, steps of the world's cameras.
    pub rate: f64,
    /// Age of the newest data it has used, s; not a number where it has used none.
    pub age: f64,
    /// Messages that it missed, by their numbers.
    pub lost: u64,
    /// Messages that it refused.
    pub refused: u64,
    /// Periods that it missed.
    pub missed: u64,
    /// Seconds of the experiment in a second; 0 where the programs wait for each other instead.
    pub speed: f64,
    /// What last went wrong; empty where nothing did.
    pub fault: String,
}

impl Heartbeat {
    /// The place of the program, if there is one for it.
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

/// Stops the hand, whoever sends it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StopMessage {
    /// Version of the messages.
    pub protocol: u32,
    /// Who says so, for the screen and the record; at most 256 bytes of it are kept.
    pub from: String,
    /// Number that the sender draws: messages of the same number are one stop, said again. 0: none is drawn, and
    /// stops of the same sender are one.
    pub id: u64,
}

message!(
    StopMessage,
    "Stop",
    "# Stops the hand, whoever sends it",
    "uint32 protocol  # version of the messages",
    "string from  # who says so",
    "uint64 id  # that the sender draws: the same again is the same stop; 0 for none",
);

/// Resumes a stop. The hand goes on when each stop in force has been resumed and its cause is gone.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ResumeMessage {
    /// Version of the messages.
    pub protocol: u32,
    /// Who says so, for the screen and the record.
    pub from: String,
    /// The stop: [`StopInForce::number`].
    pub number: u64,
}

message!(
    ResumeMessage,
    "Resume",
    "# Resumes a stop; the hand goes on when each stop in force has been resumed",
    "uint32 protocol  # version of the messages",
    "string from  # who says so",
    "uint64 number  # of the stop, in HandMode.stops",
);
