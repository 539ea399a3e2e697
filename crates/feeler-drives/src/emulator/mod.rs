//! A bus of servos that are not there, which answers as they would, when they would.
//!
//! Servos have the control table that [`registers`](crate::registers) names and hold their rules: no EEPROM is written while the
//! torque is on, a bus watchdog that hears nothing stops its motor, a goal beyond the velocity limit is refused. What they move is a
//! [`Plant`]. Bytes take their time on the wire by the baud rate; every packet is logged with its time, and faults can be injected.
//! [`Emulator`] is such a bus on a pseudo-terminal, in real time, for any program; [`Lockstep`] one in this program, whose time waits
//! for it.

mod bus;
mod fault;
mod instructions;
mod lockstep;
mod log;
mod plant;
mod servo;
mod servos;
mod terminal;

pub use bus::EmulatedBus;
pub use fault::BusFault;
pub use lockstep::Lockstep;
pub use log::{LogEntry, PacketLog};
pub use plant::{LagPlant, Motion, Plant};
pub use servo::EmulatedServo;
pub use servos::EmulatorConfig;
pub use terminal::{Emulator, EmulatorError};
