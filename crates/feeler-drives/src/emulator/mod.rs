//! A bus of servos that are not there: a pseudo-terminal that answers as they would, when they would.
//!
//! Servos have the control table that [`registers`](crate::registers) names and hold their rules: no EEPROM is written while the
//! torque is on, a bus watchdog that hears nothing stops its motor, a goal beyond the velocity limit is refused. What they move is a
//! [`Plant`]. Bytes take their time on the wire by the baud rate; every packet is logged with its time, and faults can be injected.

mod fault;
mod log;
mod plant;
mod run;
mod servo;
mod servos;

pub use fault::BusFault;
pub use log::{LogEntry, PacketLog};
pub use plant::{LagPlant, Motion, Plant};
pub use run::{Emulator, EmulatorError};
pub use servo::EmulatedServo;
pub use servos::{EmulatorConfig, Servos};
