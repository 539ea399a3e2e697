//! The sensor stage: optics, moments, calibration, and finding the elements in pictures.

mod accuracy;
mod calibration;
mod locate;
mod markers;
mod optics;
mod reference_calibration;
