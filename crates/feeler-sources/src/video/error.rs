//! Errors of Video4Linux cameras.

use std::io;
use std::path::PathBuf;

/// Error of a Video4Linux camera.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// An operation on the device failed.
    #[error("{}: {what}: {source}; expected a Video4Linux camera", device.display())]
    Device {
        /// Path of the device.
        device: PathBuf,
        /// The operation that failed.
        what: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The camera does not offer this size in a known format.
    #[error(
        "{}: expected images of {width}x{height} px as GREY, YUYV or MJPG; the camera offers {offered}",
        device.display()
    )]
    Format {
        /// Path of the device.
        device: PathBuf,
        /// Requested width, px.
        width: usize,
        /// Requested height, px.
        height: usize,
        /// Sizes and formats that the camera offers instead.
        offered: String,
    },
    /// The camera rejects a setting.
    #[error("{}: {what}: {reason}", device.display())]
    Setting {
        /// Path of the device.
        device: PathBuf,
        /// The rejected setting.
        what: String,
        /// Reason why the setting is rejected, such as a missing control or the valid range.
        reason: String,
    },
}
