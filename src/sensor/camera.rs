//! The seam between whatever takes pictures and the sensor program.

use super::frame::Frame;

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
    /// The camera could not take a picture.
    #[error("no picture: {0}")]
    Failed(String),
    /// There is no further picture (the end of a recording).
    #[error("no picture after the {count} that were taken")]
    Ended {
        /// How many pictures there were.
        count: u64,
    },
}

/// Something that takes pictures of the inside of one fingertip's dome.
pub trait Camera {
    /// Fills `frame` with the newest picture, its sequence number and its stamp.
    ///
    /// # Errors
    /// When the frame has another size than the camera's pictures, or there is no further picture.
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError>;
}
