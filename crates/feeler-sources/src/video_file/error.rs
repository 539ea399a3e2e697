//! Errors of video files.

use super::MAX_SIDE;
use super::ffmpeg::VARIABLE;
use feeler::sensor::image::CameraError;
use std::path::PathBuf;

/// Error of reading a video file.
#[derive(Debug, thiserror::Error)]
pub enum VideoFileError {
    /// ffmpeg cannot be started.
    #[error(
        "{program}: {source}; ffmpeg is required to read videos; install it with apt-get install ffmpeg, or pip install imageio-ffmpeg and \
         {}=$(python3 -c 'import imageio_ffmpeg as f; print(f.get_ffmpeg_exe())')",
        VARIABLE
    )]
    NoFfmpeg {
        /// Program that was started.
        program: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file cannot be read.
    #[error("{}: {source}; expected a video", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The path is a folder.
    #[error("{}: expected a video file, got a folder", path.display())]
    Folder {
        /// Path of the folder.
        path: PathBuf,
    },
    /// The file has zero bytes.
    #[error("{}: the file is empty; expected a video", path.display())]
    Empty {
        /// Path of the file.
        path: PathBuf,
    },
    /// ffmpeg cannot decode any frame.
    #[error("{}: no video frame found ({reason}); expected a video that ffmpeg can decode", path.display())]
    NoFrame {
        /// Path of the file.
        path: PathBuf,
        /// ffmpeg's error.
        reason: String,
    },
    /// Frames are too large.
    #[error("{}: frames of {width}x{height} px; expected at most {MAX_SIDE} px each way", path.display())]
    FrameSize {
        /// Path of the file.
        path: PathBuf,
        /// Width, px.
        width: usize,
        /// Height, px.
        height: usize,
    },
    /// A frame cannot be decoded.
    #[error(transparent)]
    Frame(#[from] CameraError),
}
