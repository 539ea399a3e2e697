#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod claims;
pub mod figures;
pub mod measures;
pub mod page_data;
pub mod pages;
pub mod run;
pub mod tasks;

pub use crate::measures::claim::{Claim, ClaimPart, DecidedBy, Relation, Verdict};
pub use crate::measures::stroke_pattern::StrokePattern;
pub use crate::measures::strokes::StrokeMeasures;
pub use crate::measures::summary::Summary;
pub use crate::run::data::{CapColumns, RunData};
pub use crate::run::finger_columns::FingerColumns;
pub use crate::run::make::{ReportError, ReportOutcome, make};
pub use crate::run::stroke::Stroke;
