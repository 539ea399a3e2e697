//! Small images: readings, layouts, elements.

mod finding;
mod groups;
mod layout;
mod sensing;
mod spots;
