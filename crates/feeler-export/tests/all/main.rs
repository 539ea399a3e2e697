//! Tests of this crate, linked into a single program.

mod data_set;
#[path = "../support/mod.rs"]
mod support;
mod table;
