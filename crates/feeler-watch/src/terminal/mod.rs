//! Terminal view of a running system: flags, forces and phase of the hand, and the state of its programs.
//!
//! [`Snapshot`](crate::Snapshot) is plain data, produced by a run in this process or from programs on a network. [`draw()`] renders
//! one on a screen of any size; [`View`] owns the terminal and its keys.

mod action;
mod dome;
mod draw;
mod finger;
mod force_list;
mod gauge;
mod palette;
mod programs;
mod rate_meter;
mod screen;
mod show;
mod status;
mod text;
mod torque;
mod view;
mod words;

pub use action::Action;
pub use draw::draw;
pub use screen::Screen;
pub use show::show_rig;
pub use text::text;
pub use view::{View, ViewError};
