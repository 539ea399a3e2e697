//! Sensors, hand and world as programs of their own.

#![cfg(all(feature = "link", unix))]

#[path = "../support/program.rs"]
mod program;

#[cfg(all(feature = "drives", target_os = "linux"))]
#[path = "../support/printed.rs"]
mod printed;

#[path = "../../../feeler-link/tests/support/ports.rs"]
mod ports;

#[path = "../../../feeler-link/tests/support/how_many.rs"]
mod how_many;

#[path = "../../../feeler-lab/tests/support/skip.rs"]
mod skip;

#[cfg(all(feature = "top", target_os = "linux"))]
#[path = "../support/terminal.rs"]
mod in_terminal;

mod cable;
mod certificates;
#[cfg(target_os = "linux")]
mod disk;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod drives;
mod faults;
mod floods;
mod hostile;
mod orders;
mod own_rig;
mod restarts;
mod rig;
mod soak;
mod taxels;
mod together;
#[cfg(all(feature = "top", target_os = "linux"))]
mod watched;
