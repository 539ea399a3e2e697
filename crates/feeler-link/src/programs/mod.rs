//! Programs of a rig: the hand program, which controls; the rig program, which moves the drives; and the sensor
//! programs of the fingertips.
//!
//! Each program runs on a [`Network`](crate::transport::network::Network) until it is interrupted. Refused programs and
//! lost messages are reported by heartbeats and warnings. No message from another program can end it.

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
mod rig_reading;
mod sensor;

pub use crate::hand::run_clock::RigSpeed;
pub use error::{ProgramError, Warn};
pub use hand::{HandProgram, Stopper};
pub use hand_config::{HandConfig, HandReport, RemoteLoop};
pub use rig::{RigProgram, RigReport};
pub use rig_config::{Rig, RigConfig, SensorOutput, ServedHand};
pub use sensor::{SensorConfig, SensorProgram};
