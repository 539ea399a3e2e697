//! The seam between whatever takes pictures and the sensor program.

use super::frame::Frame;
use std::time::Duration;

/// Why a camera delivered no frame.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// The frame to fill has another size than the camera's pictures.
    #[error(
        "the camera takes pictures of {expected_width}x{expected_height} px, the frame to fill is {width}x{height} px"
    )]
    FrameSize {
        /// Columns of the camera's pictures, px.
        expected_width: usize,
        /// Rows of the camera's pictures, px.
        expected_height: usize,
        /// Columns of the frame to fill, px.
        width: usize,
        /// Rows of the frame to fill, px.
        height: usize,
    },
    /// A picture has another size than the sensor's.
    #[error(
        "{name}: a picture of {expected_width}x{expected_height} px expected, it has {width}x{height} px"
    )]
    PictureSize {
        /// Where the picture is.
        name: String,
        /// Columns that were expected, px.
        expected_width: usize,
        /// Rows that were expected, px.
        expected_height: usize,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
    },
    /// One picture is lost; the next one may be good.
    #[error("{name}: {reason}")]
    Unreadable {
        /// Which one.
        name: String,
        /// What was expected and what was found.
        reason: String,
    },
    /// The camera could not take a picture, and will not take another one.
    #[error("no picture: {0}")]
    Failed(String),
    /// There is no further picture (the end of a recording).
    #[error("no picture after the {count} that were taken")]
    Ended {
        /// How many pictures there were.
        count: u64,
    },
}

impl CameraError {
    /// Whether one picture is lost, and the next may be good.
    pub fn may_pass(&self) -> bool {
        matches!(self, Self::Unreadable { .. } | Self::PictureSize { .. })
    }
}

/// How a picture was made, besides the picture. What a camera does not know is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CaptureReport {
    /// Number of bytes that came from the device.
    pub bytes: Option<usize>,
    /// Duration of decoding.
    pub decoding: Option<Duration>,
    /// What is wrong with the camera, but not with the picture. Reported once.
    pub warning: Option<String>,
}

/// Something that takes pictures of the inside of one fingertip's dome.
pub trait Camera {
    /// Fills `frame` with the newest picture, its sequence number and its stamp.
    ///
    /// # Errors
    /// When the frame has another size than the camera's pictures, a picture is no good, or there is
    /// no further one. After [`CameraError::Unreadable`] the camera goes on with the next picture; its
    /// sequence number tells that one is missing.
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError>;

    /// Takes the report of the newest picture.
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

/// Refuses a frame of another size than `(width, height)` of a camera's pictures, px.
///
/// # Errors
/// [`CameraError::FrameSize`].
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
