//! Calibration from moments to forces: models, fit, quality, checks of loads.

pub(crate) mod coupled;
pub(crate) mod error;
pub(crate) mod fit;
pub(crate) mod least_squares;
pub(crate) mod live;
pub(crate) mod load_check;
pub(crate) mod loads;
pub mod model;
pub(crate) mod quality;
pub(crate) mod report;
pub(crate) mod separable;
pub(crate) mod signs;

pub use coupled::{NORMAL_ORDERS, SHEAR_ORDERS};
pub use fit::{ElementRecord, LoadSample, ModelChoice, Outlier, fit};
pub use live::{
    Coverage, Delay, ForceAxes, Goal, LiveCalibration, LiveWrench, Missing, ParseAxesError, Seen,
    SeenWrench, Stage, Wrench, WrenchCoverage, WrenchMissing,
};
pub use load_check::{
    ELEMENT_RANGE, FINGERTIP_RANGE, LoadCheckError, check_axes, check_axes_of_recordings,
    check_magnitude, check_numbers, check_offsets, check_outliers, check_unloaded,
};
pub use loads::{
    COLUMNS, CapturedImage, LoadedImage, LoadsError, PLACE_COLUMNS, RecordBuilder, read_loads,
};
pub use model::{
    CALIBRATION_VERSION, Calibration, CalibrationError, CalibrationModel, CalibrationTarget,
    CoupledMap, ElementCalibration, ForceCurve, ForceMap, ForceUnit, ForceValidity, HeldOutError,
    LengthUnit, RelativeMoments, SeparableMap, explained,
};
pub use quality::{CycledReading, ElementQuality, FullScale, repeatability_and_hysteresis};
pub use report::{CalibrationReport, Errors};
