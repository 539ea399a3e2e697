//! Why there are no frames.

use super::MAX_SIDE;
use super::ffmpeg::VARIABLE;
use feeler::sensor::camera::CameraError;
use std::path::PathBuf;

/// Why a video cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum VideoFileError {
    /// ffmpeg cannot be started.
    #[error(
        "{program}: {source}; expected ffmpeg, which reads videos: apt-get install ffmpeg, or pip install imageio-ffmpeg and \
         {}=$(python3 -c 'import imageio_ffmpeg as f; print(f.get_ffmpeg_exe())')",
        VARIABLE
    )]
    NoFfmpeg {
        /// The program that was started.
        program: String,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file cannot be read.
    #[error("{}: {source}; expected a video", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A folder.
    #[error("{}: it is a folder; expected a video", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// A file of zero bytes.
    #[error("{}: the file is empty; expected a video", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// ffmpeg decodes no frame.
    #[error("{}: no frame of video in it ({reason}); expected a video that ffmpeg decodes", path.display())]
    NoFrame {
        /// The file.
        path: PathBuf,
        /// ffmpeg's error.
        reason: String,
    },
    /// Frames are too large.
    #[error("{}: frames of {width}x{height} px; expected at most {MAX_SIDE} px each way", path.display())]
    FrameSize {
        /// The file.
        path: PathBuf,
        /// Columns, px.
        width: usize,
        /// Rows, px.
        height: usize,
    },
    /// A frame cannot be decoded.
    #[error(transparent)]
    Frame(#[from] CameraError),
}
