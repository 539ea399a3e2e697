#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod bus;
pub(crate) mod clock;
pub mod config;
pub mod emulator;
pub(crate) mod error;
pub mod hand;
pub(crate) mod health;
pub mod packet;
pub(crate) mod port;
pub mod registers;
pub(crate) mod serial;
pub(crate) mod servo;
pub mod setup;
pub mod torque;

pub use clock::RigClock;
pub use error::{DriveError, JointName, TORQUE_MAY_BE_ON};
pub use port::Port;
