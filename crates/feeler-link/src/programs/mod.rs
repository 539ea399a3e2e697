//! The programs of a rig as types: a hand that controls, a rig that moves, a fingertip that senses.
//!
//! Each is made on a [`Network`](crate::network::Network), does one thing until it is told to end, and reports what
//! it refuses or misses by heartbeat and through its warnings. None of them ends because of what another program
//! sends.

mod error;
mod hand;
mod hand_config;
mod hand_schedule;
mod hand_status;
mod hand_supervisor;
mod node;
mod refusals;
mod rig;
mod rig_config;
mod rig_fault;
mod rig_publish;
mod sensor;

pub use crate::run_clock::RigSpeed;
pub use error::{ProgramError, Warn};
pub use hand::{HandProgram, Stopper};
pub use hand_config::{HandConfig, HandReport, RemoteLoop};
pub use rig::{RigProgram, RigReport};
pub use rig_config::{Rig, RigConfig, SensorOutput, ServedHand};
pub use sensor::{SensorConfig, SensorProgram};
