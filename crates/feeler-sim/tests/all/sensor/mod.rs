//! Sensing: optics, moments, calibration, and locating elements in images.

mod accuracy;
mod calibration;
mod locate;
mod markers;
mod optics;
mod reference_calibration;
