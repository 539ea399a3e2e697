#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub(crate) mod files;
#[cfg_attr(
    not(feature = "camera"),
    allow(dead_code, reason = "only cameras average areas")
)]
pub(crate) mod fit;
#[cfg(all(feature = "genicam", target_os = "linux"))]
pub mod genicam;
mod jpeg;
#[cfg(feature = "camera")]
pub(crate) mod motion_jpeg;
pub(crate) mod natural_order;
pub(crate) mod netft;
pub(crate) mod picture;
pub(crate) mod pump;
pub(crate) mod raw;
pub(crate) mod settings;
pub mod skin;
#[cfg(all(feature = "camera", target_os = "linux"))]
pub mod video;
pub(crate) mod video_file;

pub use files::{FilesError, PictureFiles};
pub use fit::{Fit, FitError};
#[cfg(feature = "camera")]
pub use motion_jpeg::MotionJpeg;
#[cfg(feature = "camera")]
pub use motion_jpeg::MotionJpegError;
pub use netft::{
    AddressError, Command, Counts, CountsError, ForceError, ForceSample, NetFt, NetFtAddress,
    NetFtEmulator, RDT_PORT, RdtError, Record, Request, parse_counts, read_counts,
};
pub use picture::{PictureError, decode_picture, read_picture};
pub use pump::{Captured, FramePump};
pub use raw::RawFrames;
pub use settings::{CameraSettings, ParseTriggerError, Trigger};
pub use video_file::{Ffmpeg, VideoFile, VideoFileError, VideoFrames, is_video_name};
