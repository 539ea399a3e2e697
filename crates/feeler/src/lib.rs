#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod check;
pub mod control;
pub mod hand;
pub mod pace;
pub mod sensor;

/// Vector and rotation types of the public interface.
pub use glam;

/// Compiles the code of the repository's README with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
