//! Sensors as named in commands: their geometry, and the loads for their calibration.

mod geometry;
mod loads;
mod recorded;
mod wrench;

pub use geometry::{GeometryError, SensorGeometry, read_layout};
pub use loads::{LoadsFile, LoadsFileError};
pub use recorded::{file_of, named_picture};
pub use wrench::{ForcesFile, ForcesFileError, MeasuredSamples};
