//! Messages between the programs: one plain struct per message, each with its ROS 2 message text.
//!
//! Stamps are in seconds on the clock of the program given by `MessageHeader::clock`. With simulated cameras, that is
//! the world program.

use super::freshness::Echo;
use super::printable::printable;
use crate::transport::topic::ProgramRole;
use feeler::control::Phase;
use feeler::hand::MAX_FINGERS;
use feeler_record::text_enum;
use feeler_record::wire::{Quaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Version of these messages. A program rejects and reports messages of any other version.
pub const PROTOCOL: u32 = 5;

/// Value of [`TactileUpdate::largest_element`] if no element touches.
pub const NO_ELEMENT: u32 = u32::MAX;

/// Value of [`Heartbeat::finger`] for a program that does not belong to a single finger.
pub const NO_FINGER: u32 = u32::MAX;

/// Value of [`StopInForce::id`] if the sender drew no number.
pub const NO_ID: u64 = u64::MAX;

nested_message!(
    /// Sender, sequence number, stamp, and an echo of the hand's latest step that bounds the data's age.
    #[derive(Copy)]
    MessageHeader = "Header" {
        /// Version of the messages.
        protocol: u32,
        /// Random number that the sending program drew at its start.
        instance: u64,
        /// Instance of the program whose clock the stamp refers to.
        clock: u64,
        /// Sequence number among messages of the same kind.
        sequence: u64,
        /// Time at which the content was measured or computed (s).
        stamp: f64,
        /// Latest control step of the hand that had arrived by then, or 0 if none.
        echo_step: u64,
        /// The hand's token for that step.
        echo_token: u64,
        /// Age of that step at the measurement, since its arrival (s).
        echo_age: f64,
    }
    as header_text
);

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

message!(
    /// Tactile frame of one finger with its flags, computed by the sensor program from one image.
    TactileUpdate = "TactileUpdate" {
        /// Sender, stamp and echo.
        header: MessageHeader,
        /// Finger index, from 0.
        finger: u32,
        /// Frame sequence number; repeated if the camera delivered no new image.
        frame: u64,
        /// TOUCH: an element's F_z is above F1, or SLIP.
        touch: bool,
        /// SLIP: an element's shear rate is above dr.
        slip: bool,
        /// OVER: an element's F_z is above F2.
        over: bool,
        /// Touching element with the largest F_z, or 4294967295 if no element touches.
        largest_element: u32,
        /// Sum of the positive F_z (N).
        grasp_force: f64,
        /// Force on each element in its frame (N): x and y are the tangential force on the feeler by the object, z is
        /// compression, positive when pressed.
        forces: Vec<Vector3>,
        /// Shear rate |d(F_x, F_y)/dt| of each element (N/s).
        shear_rate: Vec<f64>,
        /// Bit mask of slipping elements: bit i % 8 of byte i / 8 is element i.
        #[serde(with = "serde_bytes")]
        slip_mask: Vec<u8>,
        /// Bit mask of the elements without a valid force (dark or saturated), laid out like slip_mask. Their forces are
        /// 0 N.
        #[serde(with = "serde_bytes")]
        invalid_mask: Vec<u8>,
    }
    with [header_text, vector3_text]
);

message!(
    /// Camera image of one finger, from a rig whose cameras are not on the sensor computer.
    PictureMessage = "Picture" {
        /// Sender, stamp and echo.
        header: MessageHeader,
        /// Finger index, from 0.
        finger: u32,
        /// Frame sequence number; repeated if the camera delivered no new image.
        frame: u64,
        /// Width (px).
        width: u32,
        /// Height (px).
        height: u32,
        /// Gray values, row by row from the top left.
        #[serde(with = "serde_bytes")]
        pixels: Vec<u8>,
    }
    with [header_text]
);

message!(
    /// Forces on one finger's elements, from a simulated rig that renders no images.
    DirectForces = "DirectForces" {
        /// Sender, stamp and echo.
        header: MessageHeader,
        /// Finger index, from 0.
        finger: u32,
        /// Frame sequence number; repeated if the camera delivered no new image.
        frame: u64,
        /// Force on each element (N), as in TactileUpdate.
        forces: Vec<Vector3>,
    }
    with [header_text, vector3_text]
);

nested_message!(
    /// Active stop of the hand, not resumed yet.
    StopInForce = "StopInForce" {
        /// Number that a resume order must contain.
        number: u64,
        /// Id of the order, 18446744073709551615 if its sender drew none, or 0 if the hand stopped itself.
        id: u64,
        /// Sender of the order, or the reason if the hand stopped itself.
        by: String,
    }
    as stop_in_force_text
);

message!(
    /// State of the hand, sent once per control step. The sequence number is that of the step, from 1.
    HandMode = "HandMode" {
        /// Sender and stamp; the echo is empty.
        header: MessageHeader,
        /// Unpredictable number of this step. A program that echoes it has received the step.
        token: u64,
        /// SEARCH: the fingers approach the object.
        search: bool,
        /// MOVE: the fingers move the object.
        r#move: bool,
        /// Phase of the task.
        phase: u8,
        /// Stroke number, from 1.
        stroke: u32,
        /// Reason of the stop; empty if the hand is not stopped.
        stopped: String,
        /// Active stops, oldest first. The hand resumes once each of them has been resumed.
        stops: Vec<StopInForce>,
    }
    constants [
        "uint8 SEARCH=0",
        "uint8 MOVE=1",
        "uint8 RELEASE=2",
        "uint8 RETURN=3",
        "uint8 DONE=4",
        "uint8 STOPPED=5",
    ]
    with [header_text, stop_in_force_text]
);

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
    /// Command to the drives, valid until the next one or until the rig's watchdog expires. The sequence number is that
    /// of the control step.
    CommandMessage = "HandCommand" {
        /// Sender and stamp. Stamp and clock are the rig's, of the oldest data that the command is based on.
        header: MessageHeader,
        /// Token of the step, as in HandMode.
        token: u64,
        /// Sequence number of the HandState that the command is based on.
        state_sequence: u64,
        /// Velocities of joints theta1..theta3 of each finger (rad/s, or m/s of a prismatic joint). A finger with another
        /// number of joints has one vector per three joints; the rest of its last vector is 0.
        joint_velocity: Vec<Vector3>,
    }
    with [header_text, vector3_text]
);

nested_message!(
    /// Readings of the rig's instruments, and ground truth of the cap from a simulated world.
    #[derive(Copy)]
    InstrumentsMessage = "Instruments" {
        /// Measured torque between cap and bottle (N m), positive when turned in the closing direction.
        torque: f64,
        /// Voltage of the strain-gauge bridge (V).
        bridge_voltage: f64,
        /// A/D converter counts.
        counts: i32,
        /// Rotation of the cap since the start (rad), positive in the closing direction (simulated worlds only).
        cap_angle: f64,
        /// Centre of the cap in the world frame (m; simulated worlds only).
        cap_centre: Vector3,
        /// True torque between cap and bottle (N m), positive when it resists closing (simulated worlds only).
        cap_torque: f64,
        /// Largest distance that a contact anchor of each finger slid since the previous state (m; simulated worlds
        /// only).
        slipped: [f64; MAX_FINGERS],
        /// True if the rig contains a carried object with known pose (simulated worlds only).
        has_object: bool,
        /// Origin of the object in the world frame (m).
        object_position: Vector3,
        /// Orientation of the object's frame in the world frame.
        object_orientation: Quaternion,
    }
    as instruments_text
);

message!(
    /// Encoder readings, and the rig's instruments if it has any.
    StateMessage = "HandState" {
        /// Sender, stamp and echo.
        header: MessageHeader,
        /// Joint angles theta1..theta3 of each finger (rad, or m of a prismatic joint). A finger with another number of
        /// joints has one vector per three joints; the rest of its last vector is 0.
        position: Vec<Vector3>,
        /// Joint velocities of each finger (rad/s or m/s), laid out like position.
        velocity: Vec<Vector3>,
        /// Efforts of the motors on the joints of each finger (N m, or N of a prismatic joint), laid out like position. NaN
        /// if unknown; empty if the drives measure none.
        effort: Vec<Vector3>,
        /// Uncertainty of each effort (N m or N), laid out like position, or empty.
        effort_uncertainty: Vec<Vector3>,
        /// Instruments: empty or one entry.
        instruments: Vec<InstrumentsMessage>,
    }
    with [header_text, vector3_text, instruments_text, quaternion_text]
);

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

message!(
    /// Announces a program, its configuration and its health. Sent ten times per second.
    Heartbeat = "Heartbeat" {
        /// Version of the messages. This is the first field in every version.
        protocol: u32,
        /// Random number that the program drew at its start.
        instance: u64,
        /// Kind of the program: sense, hand, world, order or another.
        program: ProgramKind,
        /// Version of feeler.
        version: String,
        /// Finger index from 0, or 4294967295 if the program does not belong to a single finger.
        finger: u32,
        /// SHA-256 of the program's experiment.
        experiment: String,
        /// SHA-256 of the fingertip that the program senses with; empty if it does not sense.
        fingertip: String,
        /// Sequence number of the heartbeat.
        sequence: u64,
        /// Rate of frames, control steps or camera steps of the world (1/s).
        rate: f64,
        /// Age of the latest data used (s), or NaN if none was used.
        age: f64,
        /// Number of lost messages, from gaps in sequence numbers.
        lost: u64,
        /// Number of rejected messages.
        refused: u64,
        /// Number of missed periods.
        missed: u64,
        /// Ratio of experiment time to real time, or 0 in lockstep.
        speed: f64,
        /// Latest fault; empty if none occurred.
        fault: String,
    }
);

impl Heartbeat {
    /// Returns the program's place in the rig, or `None` if kind and finger do not match any.
    pub fn place(&self) -> Option<ProgramRole> {
        match (&self.program, self.finger) {
            (ProgramKind::Hand, NO_FINGER) => Some(ProgramRole::Hand),
            (ProgramKind::World, NO_FINGER) => Some(ProgramRole::World),
            (ProgramKind::Order, NO_FINGER) => Some(ProgramRole::Order),
            (ProgramKind::Sense, finger) => Some(ProgramRole::Sense(usize::try_from(finger).ok()?)),
            _ => None,
        }
    }
}

message!(
    /// Order to stop the hand.
    StopMessage = "Stop" {
        /// Version of the messages.
        protocol: u32,
        /// Name of the sender for display and recording, truncated to 256 bytes.
        from: String,
        /// Random number drawn by the sender. Messages with the same number repeat one stop. 0 if none was drawn; then
        /// all stops from the same sender count as one.
        id: u64,
    }
);

message!(
    /// Order to resume from a stop. The hand moves again once each active stop has been resumed and its cause is gone.
    ResumeMessage = "Resume" {
        /// Version of the messages.
        protocol: u32,
        /// Name of the sender for display and recording.
        from: String,
        /// Number of the stop, as in HandMode.stops.
        number: u64,
    }
);
