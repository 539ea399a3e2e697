//! Where pictures come from besides a simulated fingertip: files, a stream of raw frames, a camera.
//!
//! Each is a [`Camera`](feeler::sensor::camera::Camera). Pictures are grey with 8 bits: those of 16
//! bits are scaled down, colours are weighted as in Rec. 709, transparency is ignored.

#![warn(missing_docs)]

pub mod files;
mod jpeg;
mod natural_order;
pub mod picture;
pub mod pump;
pub mod raw;
#[cfg(all(feature = "camera", target_os = "linux"))]
pub mod video;
