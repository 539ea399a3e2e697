//! The terminal view: its content, its robustness against sizes and values, and `feeler run --top` in a terminal.

mod any_input;
mod no_terminal;
mod scenes;
mod screens;
#[cfg(target_os = "linux")]
mod terminal;
