//! The sensor stage: optics, moments, calibration, and finding the elements in pictures.

mod accuracy;
mod calibration;
mod dome;
mod locate;
mod moments;
mod moments_paths;
mod optics;
mod reference_calibration;
