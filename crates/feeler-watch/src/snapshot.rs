//! What there is to be seen of a running system at one time: plain data.

use feeler::control::flags::{FingerFlags, FlagThresholds};
use feeler::control::phase::Phase;
use feeler::sensor::layout::SensingElement;
use glam::DVec3;

/// A number that is not known. It is shown as a dash, like every other that is not finite.
pub const UNKNOWN: f64 = f64::NAN;

/// All that is shown of a system.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    /// What runs: the experiment's name.
    pub title: String,
    /// Time of the newest data, s, on `clock`.
    pub time: f64,
    /// Whose time that is.
    pub clock: TimeBase,
    /// How far the hand is; nothing when no hand was heard of.
    pub task: Option<TaskState>,
    /// The fingers, in the hand's order.
    pub fingers: Vec<Finger>,
    /// The torque sensor under the bottle, if there is one.
    pub torque: Option<Torque>,
    /// Angle by which the cap was turned, rad, positive when closing. Only a simulation knows it: it is the
    /// truth, not a measurement.
    pub true_cap_angle: Option<f64>,
    /// The programs of the system.
    pub programs: Vec<Program>,
    /// The last thing that went wrong, for as long as it is worth knowing.
    pub fault: Option<Fault>,
    /// Whether the keys that stop and resume the hand do so.
    pub hand_listens: bool,
    /// Messages that the view itself missed, so that what it shows may be incomplete; nothing where it
    /// misses none.
    pub missed: Option<u64>,
    /// Something that whoever watches should know now; empty for nothing.
    pub notice: String,
}

/// Whose time it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TimeBase {
    /// That of the world.
    #[default]
    Real,
    /// That of a simulation.
    Simulated {
        /// Simulated seconds in a real second, lately.
        speed: f64,
    },
}

/// How far the hand is with its task.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TaskState {
    /// The phase.
    pub phase: Phase,
    /// The stroke, from 1.
    pub stroke: u32,
    /// Strokes of the whole task, where that is known.
    pub strokes: Option<u32>,
}

/// One finger of the hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Finger {
    /// Its number in the hand.
    pub number: usize,
    /// TOUCH, SLIP and OVER, the largest element and the grasp force.
    pub flags: FingerFlags,
    /// What raises the flags.
    pub thresholds: FlagThresholds,
    /// Grasp force at which the fingers start to move, N.
    pub grasp_target: f64,
    /// The elements on the dome.
    pub elements: Vec<SensingElement>,
    /// Force at each element, N, in its own frame `E_i`: x, y tangential on the feeler by the object, z
    /// compression, positive when pressed.
    pub forces: Vec<DVec3>,
    /// How fast the tangential force of each element changes, N/s.
    pub shear_rates: Vec<f64>,
    /// Joint angles, rad, from the base outward.
    pub joints: [f64; 3],
}

/// What the torque sensor said lately.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Torque {
    /// Torque about W's z on the bottle by the cap, N·m.
    pub newest: f64,
    /// That of the last seconds, the oldest first, N·m: of each `interval` the value furthest from 0.
    pub history: Vec<f64>,
    /// Time between two values of `history`, s.
    pub interval: f64,
}

/// One program of the system.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// What it is: `sensor`, `hand`, `rig`.
    pub name: String,
    /// The finger that it is for, if it is for one.
    pub finger: Option<usize>,
    /// Its version of feeler; empty where it is not known.
    pub version: String,
    /// How often its data come, Hz.
    pub rate: f64,
    /// Age of its newest data, s; of a silent one, for how long it has been.
    pub age: f64,
    /// Messages that arrived; nothing where that is not known.
    pub received: Option<u64>,
    /// Messages that did not, as their numbers tell: those of this program, or where it counts for itself,
    /// those that it should have got.
    pub lost: u64,
    /// Periods in which it was late; nothing where it has none to keep.
    pub late: Option<u64>,
    /// Whether it can be counted on.
    pub state: ProgramState,
}

impl Program {
    /// The part of the messages that was lost; nothing before there was one, or where it is not known.
    pub fn lost_part(&self) -> Option<f64> {
        // In floating point, where no count is too great for the sum.
        let (received, lost) = (self.received? as f64, self.lost as f64);
        let sent = received + lost;
        (sent > 0.0).then(|| lost / sent)
    }
}

/// Whether a program can be counted on.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ProgramState {
    /// Its data come.
    #[default]
    Alive,
    /// It has not been heard of for too long.
    Silent,
    /// Its data come and are not used.
    Refused {
        /// Why.
        why: String,
    },
}

/// Something that went wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// When, s, on the snapshot's clock; not a number where that is not known.
    pub time: f64,
    /// What.
    pub words: String,
    /// Whether it is over.
    pub over: bool,
}
