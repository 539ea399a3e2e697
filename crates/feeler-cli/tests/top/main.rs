//! The terminal view: what it shows, that no size and no number breaks it, and `feeler run --top` in a terminal.

#[path = "../support/program.rs"]
mod program;

#[cfg(target_os = "linux")]
#[path = "../../../feeler-lab/tests/support/skip.rs"]
mod skip;

#[cfg(target_os = "linux")]
#[path = "../support/terminal.rs"]
mod in_terminal;

mod any_input;
mod no_terminal;
mod scenes;
mod screens;
#[cfg(target_os = "linux")]
mod terminal;
