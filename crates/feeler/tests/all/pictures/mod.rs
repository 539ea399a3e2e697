//! Readings, layouts and elements computed from small images.

mod finding;
mod groups;
mod layout;
mod sensing;
mod spots;
