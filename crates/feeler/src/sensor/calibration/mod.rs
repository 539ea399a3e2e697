//! Calibration from moments to forces: models, fit, quality, checks of loads.

pub(crate) mod coupled;
pub(crate) mod element;
pub(crate) mod error;
pub(crate) mod fit;
pub(crate) mod least_squares;
pub(crate) mod live;
pub(crate) mod load_check;
pub(crate) mod load_range;
pub(crate) mod loads;
pub(crate) mod model;
pub(crate) mod outlier;
pub(crate) mod quality;
pub(crate) mod relative_moments;
pub(crate) mod report;
pub(crate) mod separable;
pub(crate) mod signs;

pub use crate::sensor::fingertip::made_for::{CalibrationTarget, LengthUnit};
pub use coupled::{CoupledMap, NORMAL_ORDERS, SHEAR_ORDERS};
pub use element::{CalibrationModel, ElementCalibration, ForceMap, ForceValidity};
pub use error::{CALIBRATION_VERSION, CalibrationError};
pub use fit::{ElementRecord, LoadSample, ModelChoice, explained, fit};
pub use live::{
    Coverage, Delay, ForceAxes, Goal, LiveCalibration, LivePresses, LiveWrench, Missing,
    ParseAxesError, Seen, SeenPress, SeenWrench, Stage, Wrench, WrenchCoverage, WrenchMissing,
};
pub use load_check::{
    LoadCheckError, check_axes, check_axes_of_recordings, check_magnitude, check_numbers,
    check_offsets, check_outliers, check_unloaded,
};
pub use load_range::{ELEMENT_RANGE, FINGERTIP_RANGE};
pub use loads::{
    COLUMNS, CapturedImage, LoadedImage, LoadsError, PLACE_COLUMNS, RecordBuilder, read_loads,
};
pub use model::{Calibration, ForceUnit};
pub use outlier::Outlier;
pub use quality::{
    CycledReading, ElementQuality, FullScale, HeldOutError, repeatability_and_hysteresis,
};
pub use relative_moments::RelativeMoments;
pub use report::{CalibrationReport, Errors};
pub use separable::{ForceCurve, SeparableMap};
