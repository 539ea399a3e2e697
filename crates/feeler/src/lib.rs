#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod check;
pub mod control;
pub mod hand;
pub mod pace;
pub mod sensor;

/// The vectors and rotations of the public interface.
pub use glam;

/// The code of the repository's README is compiled with the documentation's tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
