//! The tests of this crate: linked once, and all at once over the processors.

mod data_set;
#[path = "../support/mod.rs"]
mod support;
mod table;
