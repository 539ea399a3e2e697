//! Tests of this crate, linked into a single program, except one that requires a separate process.

mod claims;
mod figures;
mod long_run;
mod page_contract;
mod page_data;
mod real_rig;
mod report;
mod strokes;
#[path = "../../../feeler-record/tests/support/mod.rs"]
mod support;
