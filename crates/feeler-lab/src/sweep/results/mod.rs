//! Tables of trials on disk and their summary.

pub(crate) mod claim_columns;
pub(crate) mod files;
pub mod store;
pub(crate) mod stroke_columns;
pub mod summary;
pub(crate) mod table;

pub use store::{GROWING, SUMMARY_PAGE, Store, TRIALS, read_finished, write_whole};
pub use table::line;
