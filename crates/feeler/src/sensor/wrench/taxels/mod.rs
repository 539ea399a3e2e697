//! Wrench and place of contact from all taxels of a three-axis array.
//!
//! Features are the readings v (3 components per taxel, in N or counts), and three kinds of terms are compared by
//! cross-validation:
//!
//! - linear: v;
//! - quadratic: v and the products of its components;
//! - pattern: the direction v/|v| of all readings together, ln |v|, and their products. Under a magnetic skin, the
//!   direction depends on the place of contact, and |v| on the depth.
//!
//! Each kind also has a variant with memory: the difference between v and its low-pass filter, for five time constants
//! ([`Memory`]). It models the hysteresis and creep of a viscoelastic skin as a generalised Maxwell solid, linear in v.
//! [`join()`] assigns measured wrenches to the rows of taxel recordings by time.

mod basis;
mod estimator;
mod join;
mod memory;
mod sensor;

pub use basis::{TaxelBasis, TaxelTerms, TermKind};
pub use estimator::TaxelWrenchEstimator;
pub use join::{MAX_DELAY, MeasuredAt, MeasuredSeries, TaxelSeries, estimate_delay, join};
pub use memory::{Memory, TIME_CONSTANTS, TaxelInput};
pub use sensor::TaxelWrenchSensor;

use super::{CalibrationOf, SampleOf};

/// Wrench calibration of a taxel array.
pub type TaxelCalibration = CalibrationOf<TaxelBasis>;
/// Taxel readings and the wrench measured at the same time.
pub type TaxelSample = SampleOf<TaxelBasis>;
