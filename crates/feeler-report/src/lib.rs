#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod calibration_page;
pub mod cap;
pub mod claim;
pub mod claims;
mod claims_table;
pub mod compare_page;
mod contact;
mod contour_points;
pub mod criterion;
mod document;
pub mod figures;
pub mod grasp_slip_page;
pub mod identify_page;
pub mod law_shares_page;
pub mod live_page;
pub mod long_run;
pub mod make;
pub mod measures;
mod page;
pub mod page_data;
pub mod path_fit;
mod peaks;
pub mod ranges_table;
pub mod robustness_page;
pub mod rows;
pub mod run_data;
pub mod series;
pub mod slip_page;
pub mod stroke_pattern;
pub mod strokes;
pub mod summary;
pub mod sweep_page;
pub mod tasks;
pub mod text;
pub mod thinned;
pub mod tune_page;
pub mod wrench_page;

pub use claim::{Claim, ClaimPart, DecidedBy, Relation, Verdict};
pub use make::{ReportError, ReportOutcome, make};
pub use run_data::{CapColumns, FingerColumns, RunData, Stroke};
pub use stroke_pattern::StrokePattern;
pub use strokes::StrokeMeasures;
pub use summary::Summary;
