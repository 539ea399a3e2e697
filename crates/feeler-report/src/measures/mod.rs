//! Measures of a run.

pub(crate) mod cap;
pub(crate) mod claim;
pub(crate) mod contact;
pub(crate) mod contour_points;
pub(crate) mod criterion;
mod judgement;
pub(crate) mod measure_stroke;
pub(crate) mod overload;
pub(crate) mod path_fit;
pub(crate) mod paths;
pub(crate) mod peaks;
pub(crate) mod series;
pub(crate) mod smoothing;
pub(crate) mod stroke_pattern;
pub(crate) mod strokes;
pub(crate) mod summary;

pub use cap::{CapMeasures, TIGHT};
pub use criterion::{Criterion, Success};
pub use series::percentile;
pub use stroke_pattern::Peaks;
pub use strokes::TRUE_SLIP;
