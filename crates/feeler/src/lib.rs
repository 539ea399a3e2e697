#![doc = include_str!("../README.md")]
#![warn(missing_docs)]
#![cfg_attr(
    test,
    allow(
        clippy::disallowed_methods,
        reason = "test inputs need not be bit-identical across platforms"
    )
)]

pub mod check;
pub mod control;
pub mod hand;
pub mod math;
pub mod pace;
pub mod sensor;

pub use control::task::TaskConfig;
pub use control::{ControlConfig, ControlLoop, OpticalFinger, Phase, SetupError};
/// Re-exported because its vector and rotation types are part of the public interface.
pub use glam;
pub use hand::{FingerConfig, Hand};
pub use pace::FixedRate;
pub use sensor::calibration::Calibration;
pub use sensor::image::Camera;

/// Includes the examples of the repository's README in the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
