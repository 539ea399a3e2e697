//! Interface between image sources and sensors.

use super::frame::Frame;
use std::time::Duration;

/// Error of a camera.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// The frame to fill does not have the size of the camera's images.
    #[error(
        "expected a frame of {expected_width}x{expected_height} px like the camera's images, got {width}x{height} px"
    )]
    FrameSize {
        /// Columns of the camera's images, px.
        expected_width: usize,
        /// Rows of the camera's images, px.
        expected_height: usize,
        /// Columns of the frame to fill, px.
        width: usize,
        /// Rows of the frame to fill, px.
        height: usize,
    },
    /// An image does not have the size of the sensor's images.
    #[error(
        "{name}: expected an image of {expected_width}x{expected_height} px, got {width}x{height} px"
    )]
    PictureSize {
        /// Name of the image.
        name: String,
        /// Expected width, px.
        expected_width: usize,
        /// Expected height, px.
        expected_height: usize,
        /// Columns of the image, px.
        width: usize,
        /// Rows of the image, px.
        height: usize,
    },
    /// An image cannot be read; the next one may be valid.
    #[error("{name}: {reason}")]
    Unreadable {
        /// Name of the image.
        name: String,
        /// Reason, with the expected and the actual value.
        reason: String,
    },
    /// The camera has failed and delivers no further images.
    #[error("no image: {0}")]
    Failed(String),
    /// There are no further images (end of a recording).
    #[error("no image after the first {count}")]
    Ended {
        /// Number of images captured.
        count: u64,
    },
}

impl CameraError {
    /// Returns whether only one image is lost and the next one may be valid.
    pub fn is_recoverable(&self) -> bool {
        matches!(self, Self::Unreadable { .. } | Self::PictureSize { .. })
    }
}

/// Additional information about a capture; fields are `None` if the camera does not report them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CaptureReport {
    /// Number of bytes received from the device.
    pub bytes: Option<usize>,
    /// Duration of decoding the image.
    pub decoding: Option<Duration>,
    /// Camera problem that does not affect the image; reported once.
    pub warning: Option<String>,
}

/// A source of images of the inside of one fingertip's dome.
pub trait Camera {
    /// Fills `frame` with the latest image, its sequence number and its stamp.
    ///
    /// # Errors
    /// If the frame does not have the size of the camera's images, an image is invalid, or there are no further
    /// images. After [`CameraError::Unreadable`] the camera continues with the next image; the gap in its sequence
    /// numbers indicates the missing one.
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError>;

    /// Returns and resets the report on the latest image.
    fn take_report(&mut self) -> CaptureReport {
        CaptureReport::default()
    }
}

impl<C: Camera + ?Sized> Camera for Box<C> {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        (**self).capture(frame)
    }

    fn take_report(&mut self) -> CaptureReport {
        (**self).take_report()
    }
}

/// Checks that a frame has the size `(width, height)` of a camera's images, px.
///
/// # Errors
/// Returns [`CameraError::FrameSize`] if it does not.
pub fn check_frame_size((width, height): (usize, usize), frame: &Frame) -> Result<(), CameraError> {
    let picture = &frame.picture;
    if (picture.width, picture.height, picture.pixels.len()) == (width, height, width * height) {
        return Ok(());
    }
    Err(CameraError::FrameSize {
        expected_width: width,
        expected_height: height,
        width: picture.width,
        height: picture.height,
    })
}
