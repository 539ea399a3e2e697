//! The terminal view: what it shows, that no size and no number breaks it, and `feeler run --top` in a terminal.

mod any_input;
mod no_terminal;
mod scenes;
mod screens;
#[cfg(target_os = "linux")]
mod terminal;
