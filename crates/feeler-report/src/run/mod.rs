//! A recorded run as columns; runs that are too long for memory are decimated.

pub(crate) mod data;
pub(crate) mod file_names;
pub(crate) mod finger_columns;
pub(crate) mod long_run;
pub mod make;
mod recorder;
pub(crate) mod rows;
pub(crate) mod stroke;
mod summarize;
pub(crate) mod thinned;

pub use data::RunData;
pub use file_names::{RECORDING, REPORT, SUMMARY};
pub use finger_columns::FingerColumns;
pub use long_run::{read, read_within};
pub use make::{
    ReportError, ReportOutcome, create_folder, make, make_into, make_of, page_from, page_of,
    summary_from,
};
pub use recorder::RunRecorder;
pub use stroke::Stroke;
