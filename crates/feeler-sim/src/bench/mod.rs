//! Simulated calibration bench: known loads on single elements.

pub(crate) mod calibration;
mod config;
pub(crate) mod element;
pub(crate) mod loads;

pub use calibration::{CalibrationBenchError, calibrate_simulated, load_simulated, take_pictures};
pub use config::CalibrationBenchConfig;
pub use element::ElementConfig;
pub use loads::Load;
