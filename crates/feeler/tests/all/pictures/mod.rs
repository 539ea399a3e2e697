//! What is made of small pictures: readings, layouts, elements.

mod finding;
mod groups;
mod layout;
mod sensing;
mod spots;
