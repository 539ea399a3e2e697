//! Why a Video4Linux camera cannot be used.

use std::io;
use std::path::PathBuf;

/// Why a camera cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The device cannot be opened, or refuses to be set.
    #[error("{}: {what}: {source}; expected a Video4Linux camera", device.display())]
    Device {
        /// The device.
        device: PathBuf,
        /// What was tried.
        what: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// The camera has no pictures of this size and in a known format.
    #[error(
        "{}: pictures of {width}x{height} px as GREY, YUYV or MJPG expected, the camera offers {offered}",
        device.display()
    )]
    Format {
        /// The device.
        device: PathBuf,
        /// Columns that were asked for, px.
        width: usize,
        /// Rows that were asked for, px.
        height: usize,
        /// What it would do instead.
        offered: String,
    },
    /// The camera cannot be set as is asked for.
    #[error("{}: {what}: {reason}", device.display())]
    Setting {
        /// The device.
        device: PathBuf,
        /// What was to be set.
        what: String,
        /// What is missing or out of range.
        reason: String,
    },
}
