#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod history;
#[cfg(feature = "page")]
mod page;
mod rig;
mod snapshot;
#[cfg(feature = "terminal")]
mod terminal;

pub use history::History;
#[cfg(feature = "page")]
pub use page::{LiveRun, ServerOptions, serve_recording, serve_rig};
pub use rig::{RigMessages, WatchedRig};
pub use snapshot::{
    Fault, Finger, Program, ProgramState, Snapshot, TaskState, TimeBase, Torque, UNKNOWN,
};
#[cfg(feature = "terminal")]
pub use terminal::{Action, Screen, View, ViewError, draw, show_rig, text};

/// Aborts tests that allocate within `assert_no_alloc`.
#[cfg(test)]
#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;
