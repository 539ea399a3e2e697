//! Emulated servo bus with realistic timing.
//!
//! Servos have the control table of [`registers`](crate::registers) and follow its rules: the EEPROM cannot be written
//! while torque is on, a bus watchdog without instructions stops the motor, and a goal above the velocity limit is
//! rejected. They move a [`Plant`]. Bytes take their transmission time at the baud rate; every packet is logged with
//! its time, and faults can be injected. [`Emulator`] provides the bus on a pseudo-terminal in real time, for any
//! program. [`Lockstep`] provides it in-process with simulated time.

mod bus;
mod fault;
mod instructions;
mod lockstep;
mod log;
mod motor;
mod plant;
mod servo;
mod servos;
#[cfg(target_os = "linux")]
mod terminal;

pub use bus::EmulatedBus;
pub use fault::BusFault;
pub use lockstep::Lockstep;
pub use log::{LogEntry, PacketLog};
pub use plant::{LagPlant, LoadedPlant, Motion, Plant};
pub use servo::EmulatedServo;
pub use servos::EmulatorConfig;
#[cfg(target_os = "linux")]
pub use terminal::{Emulator, EmulatorError};
