//! Destinations for readings: a table, JSON Lines, or MCAP.

mod filed;
mod format;
mod frame_output;
mod image_format;
mod prompt;
mod row_file;
mod whole_rows;

pub use format::{Format, open};
pub use frame_output::{FrameReadings, Output, partial};
pub use image_format::{ForceRow, ImageFormat, moments, tactile};
pub use row_file::RowFile;
