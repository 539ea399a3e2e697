//! Sensors, hand and world as separate processes.

#![cfg(unix)]

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
mod soak;
mod taxels;
mod together;
#[cfg(all(feature = "top", target_os = "linux"))]
mod watched;
