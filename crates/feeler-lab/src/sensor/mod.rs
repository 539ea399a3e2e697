//! A sensor as it is named in commands: its geometry, and the loads that it is calibrated with.

mod geometry;
mod loads;
mod recorded;
mod wrench;

pub use geometry::{GeometryError, SensorGeometry, read_layout};
pub use loads::{LoadsFile, LoadsFileError};
pub use recorded::{file_of, named_picture};
pub use wrench::{ForcesFile, ForcesFileError, MeasuredSamples};
