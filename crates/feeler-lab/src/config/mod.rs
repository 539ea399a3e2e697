//! The experiment file: one documented struct, read from TOML and checked once before it is converted to runtime
//! objects.

mod blame;
mod built_in;
mod calibrations;
mod check;
mod describe;
mod error;
mod experiment_config;
mod in_short;
pub mod key;
mod load;
mod missing;
mod place;
mod policy;
mod read;
mod ros2;
mod settings;
mod stand_in;
mod urdf;
mod words;

pub use built_in::{BUILT_IN, BuiltIn};
pub use calibrations::built_in_calibration;
pub use describe::ValueDescription;
pub use error::ConfigError;
pub use experiment_config::{
    ExperimentConfig, FingerSensorConfig, HandConfig, Sensing, SensorConfig,
};
pub use feeler::check::Problem;
pub use load::Experiment;
pub(crate) use read::read_text;
pub use ros2::{RosConfig, RosFingerConfig, RosGripperConfig};
