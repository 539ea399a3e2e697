//! The simulated world: what a fingertip touches, and what its camera sees.

pub mod calibration_bench;
pub mod camera_noise;
pub mod optics;
pub mod optics_config;
pub mod optics_model;
