//! Simulated calibration bench: known loads on single elements.

pub(crate) mod calibration;
pub(crate) mod element;
pub(crate) mod loads;

pub use calibration::{
    CalibrationBenchConfig, CalibrationBenchError, Load, calibrate_simulated, load_simulated,
    take_pictures,
};
pub use element::ElementConfig;
