//! Tactile sensing: from an image of the dome's inside to tri-axial forces on its elements.
//!
//! The stages are: image ([`camera`], [`frame`]) → integrated gray value and centroid per element ([`moments`], with
//! the dewarping of [`dome`]) → forces ([`calibration`]) → [`reading`]. [`sensing`] is the complete chain, which also
//! works without a calibration; [`optical`] connects it to a camera.
//!
//! Three-axis taxel arrays have no images: [`taxel`] reads their tables. [`table`] reads tables of all kinds.

pub mod calibration;
pub mod calibration_error;
pub mod calibration_fit;
pub mod calibration_quality;
pub mod calibration_report;
mod calibration_signs;
pub mod camera;
mod cells;
pub mod coupled;
mod difference;
pub mod dome;
pub mod drift;
pub mod exposure;
pub mod fingertip;
mod folds;
pub mod frame;
pub mod layout;
mod least_squares;
pub mod likeness;
pub mod live_calibration;
pub mod load_check;
pub mod loads;
pub mod locate;
pub mod located_layout;
pub mod made_for;
pub mod mismatch;
pub mod moments;
pub mod moments_config;
pub mod optical;
pub mod polarity;
mod radial_distortion;
pub mod reading;
pub mod seen;
pub mod sensing;
pub mod separable;
pub mod subregion;
pub mod table;
pub mod taxel;
pub mod track;
pub mod wrench;
