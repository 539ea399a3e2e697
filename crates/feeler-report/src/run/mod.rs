//! A recorded run as columns; runs that are too long for memory are decimated.

pub(crate) mod data;
pub(crate) mod long_run;
pub mod make;
pub(crate) mod rows;
pub(crate) mod thinned;

pub use data::{FingerColumns, RunData, Stroke};
pub use long_run::{RunRecorder, read, read_within};
pub use make::{
    RECORDING, REPORT, ReportError, ReportOutcome, SUMMARY, create_folder, make, make_into,
    make_of, page_of, report_from,
};
