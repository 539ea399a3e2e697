//! The programs of a rig as types: a hand that controls, a rig that moves, a fingertip that senses.
//!
//! Each is made on a [`Network`](crate::network::Network), does one thing until it is told to end, and reports what
//! it refuses or misses by heartbeat and through its warnings. None of them ends because of what another program
//! sends.

mod hand;
mod hand_schedule;
mod hand_status;
mod hand_supervisor;
mod node;
mod refusals;
mod rig;
mod rig_config;
mod rig_publish;
mod sensor;

pub use hand::{HandConfig, HandProgram, HandReport, RemoteLoop};
pub use rig::{RigProgram, RigReport};
pub use rig_config::{Rig, RigConfig, RigSpeed, SensorOutput, ServedHand};
pub use sensor::{SensorConfig, SensorProgram};

use crate::endpoints::LinkError;
use crate::mismatch::Mismatch;
use feeler::control::control_loop::ControlError;
use feeler::hand::HandError;
use feeler::pace::PaceError;
use feeler::sensor::reading::SensorError;

/// Takes a warning for whoever runs the program, in one line.
pub type Warn = Box<dyn FnMut(&str) + Send>;

/// Why a program of a rig cannot start or go on.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The network does not carry messages any more.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Another program does not agree with this one.
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    /// The control loop cannot go on.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// There is no such period.
    #[error(transparent)]
    Pace(#[from] PaceError),
    /// The rig's drives or encoders fail.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// The sensor of a finger delivers nothing.
    #[error("finger {finger}: {source}")]
    Sensor {
        /// The finger.
        finger: usize,
        /// What the sensor said.
        source: SensorError,
    },
}
