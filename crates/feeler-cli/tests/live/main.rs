//! Programs that run together in real time: distributed rigs, and programs that watch them. They share one test binary,
//! because every binary is linked separately; `program` contains the tests that need no real time.

#[cfg(feature = "link")]
mod campaign;
#[cfg(feature = "drives")]
mod drives;
#[cfg(target_os = "linux")]
mod emulated;
#[cfg(feature = "drives")]
mod gripper_servos;
#[cfg(all(feature = "link", unix))]
#[path = "../../../feeler-link/tests/support/how_many.rs"]
mod how_many;
#[cfg(all(feature = "top", target_os = "linux"))]
#[path = "../support/terminal.rs"]
mod in_terminal;
#[cfg(feature = "link")]
mod lerobot;
#[cfg(feature = "link")]
mod link;
#[cfg(feature = "link")]
mod link_python;
#[cfg(feature = "link")]
#[path = "../../../feeler-link/tests/support/ports.rs"]
mod ports;
#[cfg(all(feature = "drives", feature = "link", target_os = "linux"))]
#[path = "../support/printed.rs"]
mod printed;
#[path = "../support/program.rs"]
mod program;
#[cfg(feature = "link")]
mod rig;
#[cfg(feature = "ros2")]
mod ros2;
mod skins;
#[path = "../../../feeler-lab/tests/support/skip.rs"]
mod skip;
#[cfg(feature = "top")]
mod top;
#[cfg(feature = "view")]
mod view;
#[cfg(all(feature = "drives", feature = "link", feature = "top"))]
mod your_rig;
