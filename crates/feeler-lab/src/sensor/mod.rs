//! A sensor as it is named in commands: its geometry, and the loads that it is calibrated with.

mod geometry;
mod loads;

pub use geometry::{GeometryError, SensorGeometry};
pub use loads::{LoadsFile, LoadsFileError};
