//! Recordings of whole runs: read by other tools, rewritten and replayed.

mod live_columns;
#[path = "../../../../feeler-record/tests/support/python.rs"]
mod python;
mod replay;
mod rewritten;
mod tactile_array;
mod viewers;
