//! A camera that reads video files, decoded by ffmpeg.

mod error;
mod ffmpeg;
mod frames;

pub use error::VideoFileError;
pub use ffmpeg::Ffmpeg;
pub use frames::VideoFrames;

use feeler::sensor::image::{Camera, CameraError, CaptureReport, Frame, check_frame_size};
use ffmpeg::{FrameInfo, listen};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};

/// Extensions of video files, in lower case; any case is accepted.
pub const EXTENSIONS: [&str; 6] = ["avi", "mp4", "mkv", "mov", "webm", "m4v"];

/// Maximum width or height of a frame, px.
const MAX_SIDE: usize = 16_384;
/// Frame rate of a file that contains neither times nor a rate, Hz; the same as ffmpeg's.
const ASSUMED_RATE: f64 = 25.0;

/// Returns whether `path` has the extension of a video file.
pub fn is_video_name(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.is_some_and(|e| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(e)))
}

/// A camera that reads the first video stream of a file, as 8-bit grey (the luma, Rec. 601), rotated as specified in
/// the file's metadata.
///
/// Stamps are the frames' presentation times in seconds from the beginning of the file. A damaged file ends with
/// [`CameraError::Failed`] after the frames that ffmpeg can decode.
#[derive(Debug)]
pub struct VideoFile {
    path: PathBuf,
    ffmpeg: Child,
    pixels: ChildStdout,
    infos: Receiver<FrameInfo>,
    /// Thread that reads ffmpeg's messages. Returns the first report of damage when ffmpeg has ended.
    listener: Option<JoinHandle<Option<String>>>,
    complaint: Option<String>,
    /// Properties of the next frame, if already received from ffmpeg.
    next: Option<FrameInfo>,
    size: (usize, usize),
    rate: Option<f64>,
    /// Frame rate that replaces the file's times, Hz.
    assumed_rate: Option<f64>,
    count: u64,
    last_stamp: f64,
    untimed: bool,
    warning: Option<String>,
}

impl VideoFile {
    /// Opens the video at `path` and decodes its first frame.
    ///
    /// # Errors
    /// If ffmpeg is missing, or cannot decode any frame of the file.
    pub fn open(path: &Path) -> Result<Self, VideoFileError> {
        let path = path.to_path_buf();
        match std::fs::metadata(&path) {
            Err(source) => return Err(VideoFileError::Read { path, source }),
            Ok(found) if found.is_dir() => return Err(VideoFileError::Folder { path }),
            Ok(found) if found.is_file() && found.len() == 0 => {
                return Err(VideoFileError::Empty { path });
            }
            Ok(_) => {}
        }
        let program = Ffmpeg::find()?;
        let (ffmpeg, pixels, messages) = program.decode(&path)?;
        let (sender, infos) = channel();
        let mut video = Self {
            path,
            ffmpeg,
            pixels,
            infos,
            listener: Some(thread::spawn(move || listen(messages, &sender))),
            complaint: None,
            next: None,
            size: (0, 0),
            rate: None,
            assumed_rate: None,
            count: 0,
            last_stamp: 0.0,
            untimed: false,
            warning: None,
        };
        let Ok(first) = video.infos.recv() else {
            return Err(VideoFileError::NoFrame {
                reason: video.problem().unwrap_or_else(|| "it contains none".into()),
                path: video.path.clone(),
            });
        };
        let (width, height) = first.size;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(VideoFileError::FrameSize {
                path: video.path.clone(),
                width,
                height,
            });
        }
        (video.size, video.rate) = (first.size, first.rate);
        video.next = Some(first);
        Ok(video)
    }

    /// Replaces the file's times if `rate` (Hz) is given: frame k (from 0) gets the stamp `k / rate`.
    #[must_use]
    pub fn at_rate(mut self, rate: Option<f64>) -> Self {
        self.assumed_rate = rate;
        self
    }

    /// Width and height of the frames, px.
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// Nominal frame rate, Hz, or `None` if the file has none.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Waits for ffmpeg to end. Returns the problem, or `None` if the file was decoded to its end.
    fn problem(&mut self) -> Option<String> {
        if let Some(listener) = self.listener.take() {
            let complaint = listener.join();
            self.complaint = complaint.unwrap_or_else(|_| Some("its messages are lost".into()));
        }
        if self.complaint.is_some() {
            // ffmpeg may be blocked on writing frames.
            let _ = self.ffmpeg.kill();
        }
        let ended = self.ffmpeg.wait();
        let status = match ended {
            Ok(status) if status.success() => None,
            Ok(status) => Some(format!("ffmpeg ended with {status}")),
            Err(error) => Some(error.to_string()),
        };
        let complaint = self.complaint.as_ref();
        complaint.map(|what| format!("ffmpeg: {what}")).or(status)
    }

    /// Returns the error for the end of the video, or for the damage that ends it. `torn` is `true` if it ended in the
    /// middle of a frame.
    fn end(&mut self, torn: bool) -> CameraError {
        let count = self.count;
        let problem = self.problem();
        let torn = torn.then(|| format!("it ends within frame {count}"));
        match problem.or(torn) {
            None => CameraError::Ended { count },
            Some(problem) => self.failed(&format!(
                "the video is damaged or truncated, {count} frames were decoded ({problem}); `ffmpeg -i FILE -c:v ffv1 NEW.mkv` \
                 saves the decodable frames as a new video"
            )),
        }
    }

    fn failed(&self, what: &str) -> CameraError {
        CameraError::Failed(format!("{}: {what}", self.path.display()))
    }

    fn stamp_of(&mut self, info: &FrameInfo) -> f64 {
        if let Some(rate) = self.assumed_rate {
            return self.count as f64 / rate;
        }
        if let Some(stamp) = info.stamp {
            return stamp;
        }
        let rate = self.rate.unwrap_or(ASSUMED_RATE);
        if !std::mem::replace(&mut self.untimed, true) {
            let (path, count) = (self.path.display(), self.count);
            self.warning = Some(format!(
                "{path}: frame {count} has no presentation time; such frames are stamped at {rate} Hz"
            ));
        }
        match self.count {
            0 => 0.0,
            _ => self.last_stamp + 1.0 / rate,
        }
    }
}

impl Camera for VideoFile {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size(self.size, frame)?;
        let info = self.next.take().or_else(|| self.infos.recv().ok());
        let Some(info) = info else {
            return Err(self.end(false));
        };
        let ((width, height), (columns, rows)) = (info.size, self.size);
        if info.size != self.size {
            let count = self.count;
            return Err(self.failed(&format!(
                "frame {count} has {width}x{height} px; expected {columns}x{rows} px like the first frame"
            )));
        }
        if self.pixels.read_exact(&mut frame.picture.pixels).is_err() {
            return Err(self.end(true));
        }
        frame.sequence = self.count;
        frame.stamp = self.stamp_of(&info);
        self.last_stamp = frame.stamp;
        self.count += 1;
        Ok(())
    }

    fn take_report(&mut self) -> CaptureReport {
        CaptureReport {
            warning: self.warning.take(),
            ..CaptureReport::default()
        }
    }
}

impl Drop for VideoFile {
    fn drop(&mut self) {
        // ffmpeg may have ended already.
        let _ = self.ffmpeg.kill();
        let _ = self.ffmpeg.wait();
    }
}
