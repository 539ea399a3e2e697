#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod files;
pub mod fit;
#[cfg(all(feature = "genicam", target_os = "linux"))]
pub mod genicam;
mod jpeg;
#[cfg(feature = "camera")]
pub mod motion_jpeg;
mod natural_order;
pub mod netft;
pub mod picture;
pub mod pump;
pub mod raw;
pub mod settings;
#[cfg(all(feature = "camera", target_os = "linux"))]
pub mod video;
pub mod video_file;
