//! Plain-data snapshot of a running system, for display.

use feeler::control::{FingerFlags, FlagThresholds, Phase};
use feeler::hand::JointVector;
use feeler::sensor::fingertip::SensingElement;
use glam::DVec3;

/// An unknown number. Non-finite numbers are displayed as a dash.
pub const UNKNOWN: f64 = f64::NAN;

/// State of a system at one time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    /// Title: the name of the experiment or rig.
    pub title: String,
    /// Time of the latest data (s) on `clock`.
    pub time: f64,
    /// Kind of clock of `time`.
    pub clock: TimeBase,
    /// State of the hand's task, or `None` if no hand is connected.
    pub task: Option<TaskState>,
    /// Fingers, in the hand's order.
    pub fingers: Vec<Finger>,
    /// Torque sensor under the bottle, if any.
    pub torque: Option<Torque>,
    /// Angle by which the cap was turned (rad), positive when closing. This is simulated truth, not a measurement.
    pub true_cap_angle: Option<f64>,
    /// Programs of the system.
    pub programs: Vec<Program>,
    /// Latest fault, as long as it is relevant, if any.
    pub fault: Option<Fault>,
    /// `true` if the hand obeys the keys for stop and resume.
    pub hand_listens: bool,
    /// Number of messages that the view itself missed; if above 0, the snapshot may be incomplete; `None` if it cannot
    /// miss any.
    pub missed: Option<u64>,
    /// Notice for the user; empty if none.
    pub notice: String,
}

/// Kind of clock of a snapshot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TimeBase {
    /// Real time.
    #[default]
    Real,
    /// Simulated time.
    Simulated {
        /// Current speed relative to real time.
        speed: f64,
    },
}

/// Progress of the hand's task.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TaskState {
    /// Current phase.
    pub phase: Phase,
    /// Current stroke, from 1.
    pub stroke: u32,
    /// Number of strokes of the whole task, if known.
    pub strokes: Option<u32>,
}

/// State of one finger.
#[derive(Debug, Clone, PartialEq)]
pub struct Finger {
    /// Index of the finger in the hand.
    pub number: usize,
    /// Flags TOUCH, SLIP and OVER, the element with the largest force, and the grasp force.
    pub flags: FingerFlags,
    /// Thresholds of the flags.
    pub thresholds: FlagThresholds,
    /// Grasp force at which the fingers start to move (N).
    pub grasp_target: f64,
    /// Elements on the dome.
    pub elements: Vec<SensingElement>,
    /// Force at each element (N) in its frame `E_i`: x and y tangential on the feeler by the object, z compression,
    /// positive when pressed.
    pub forces: Vec<DVec3>,
    /// Rate of change of each element's tangential force (N/s).
    pub shear_rates: Vec<f64>,
    /// Joint positions from the base outward (rad or m).
    pub joints: JointVector,
}

/// Recent readings of the torque sensor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Torque {
    /// Latest torque about W's z axis on the bottle by the cap (N·m).
    pub newest: f64,
    /// Recent torques, oldest first (N·m): for each `interval`, the value of largest magnitude.
    pub history: Vec<f64>,
    /// Time between two values of `history` (s).
    pub interval: f64,
}

/// A program of the system.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// Kind of the program: `sensor`, `hand` or `rig`.
    pub name: String,
    /// Finger that the program serves, if it serves a single one.
    pub finger: Option<usize>,
    /// Version of feeler; empty if unknown.
    pub version: String,
    /// Rate of the program's messages (Hz).
    pub rate: f64,
    /// Time since the latest message of the program (s).
    pub age: f64,
    /// Number of messages received, or `None` if unknown.
    pub received: Option<u64>,
    /// Number of lost messages, from gaps in sequence numbers: messages from this program, or messages to it if it
    /// reports that number.
    pub lost: u64,
    /// Number of periods in which the program was late, or `None` if it has no deadline.
    pub late: Option<u64>,
    /// State of the program.
    pub state: ProgramState,
}

impl Program {
    /// Returns the fraction of messages lost, or `None` if none were sent or their number is unknown.
    pub fn lost_part(&self) -> Option<f64> {
        // In floating point, the sum cannot overflow.
        let (received, lost) = (self.received? as f64, self.lost as f64);
        let sent = received + lost;
        (sent > 0.0).then(|| lost / sent)
    }
}

/// State of a program.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ProgramState {
    /// Messages arrive.
    #[default]
    Alive,
    /// Messages have not arrived for too long.
    Silent,
    /// Messages arrive, but are rejected.
    Refused {
        /// Reason for the rejection.
        why: String,
    },
}

/// A fault.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Time of the fault on the snapshot's clock (s); NaN if unknown.
    pub time: f64,
    /// Description.
    pub words: String,
    /// `true` if the fault is over.
    pub over: bool,
}
