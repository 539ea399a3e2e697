//! Destinations for readings: a table, JSON Lines, or MCAP.

mod filed;
mod format;
mod frame_output;
mod mcap;
mod prompt;
mod row_file;
mod rows;
mod whole_rows;

pub use format::{Format, ImageFormat, open};
pub use frame_output::{FrameReadings, Output, partial};
pub use mcap::{Pictures, moments};
pub use row_file::{RowFile, RowWriter};
pub use rows::ForceRow;
