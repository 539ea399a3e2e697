//! All tests of this crate in one binary, so that they link once and run in parallel.

mod data_set;
#[path = "../support/mod.rs"]
mod support;
mod table;
