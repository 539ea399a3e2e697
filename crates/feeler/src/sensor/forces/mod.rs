//! Computation of forces from moments: sensing chain, tactile frames, drift correction.

pub(crate) mod drift;
pub(crate) mod likeness;
pub(crate) mod mismatch;
pub(crate) mod optical;
pub(crate) mod reading;
pub(crate) mod sensing;

pub use drift::{DriftConfig, DriftCorrection};
pub use likeness::Likeness;
pub use mismatch::Mismatch;
pub use optical::OpticalSensor;
pub use reading::{NO_FORCE, SensorError, TactileFrame, TactileSensor};
pub use sensing::{ElementReading, Reference, SensingChain, SensingError};
