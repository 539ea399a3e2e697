//! A Video4Linux camera.
//!
//! Its pictures are taken as grey (`GREY`), as the luma of `YUYV`, or as Motion JPEG, in this order
//! of preference.

mod clock;
mod coding;
mod controls;
mod error;
mod list;

pub use error::VideoError;
pub use list::{VideoControl, VideoFormat, VideoInfo, VideoListed, VideoSize, list};

use crate::settings::{CameraSettings, Trigger};
use clock::FrameClock;
use coding::{Coding, unpack};
use controls::set_controls;
use feeler::sensor::camera::{Camera, CameraError, check_frame_size};
use feeler::sensor::frame::Frame;
use linuxvideo::format::PixFormat;
use linuxvideo::stream::ReadStream;
use linuxvideo::{Device, Fract, VideoCaptureDevice};
use std::io;
use std::path::PathBuf;
use std::time::Instant;

/// What the system says of a device that is gone (`ENODEV`).
const NO_SUCH_DEVICE: i32 = 19;

/// Which camera, and how it is set.
#[derive(Debug, Clone, PartialEq)]
pub struct VideoConfig {
    /// The device, as in `/dev/video0`.
    pub device: PathBuf,
    /// How it is set. The library has neither the selection of a region nor triggers: a camera that is asked for these is refused.
    pub settings: CameraSettings,
}

/// A camera that takes pictures all the time.
///
/// Stamps are the time of arrival since the camera was opened. The driver's frame counter is not to
/// be had from the library, so sequence numbers count frame intervals between arrivals, and a gap is
/// where an interval was at least 1.5 times as long as the camera's rate says.
pub struct VideoCamera {
    stream: ReadStream,
    name: String,
    coding: Coding,
    size: (usize, usize),
    /// Bytes from a row to the next.
    stride: usize,
    clock: FrameClock,
    opened: Instant,
}

impl VideoCamera {
    /// Opens and sets the camera, and starts it.
    ///
    /// # Errors
    /// When there is no camera, or it cannot be set as `config` says.
    pub fn open(config: &VideoConfig) -> Result<Self, VideoError> {
        let failed = |what: &'static str| {
            move |source| VideoError::Device {
                device: config.device.clone(),
                what,
                source,
            }
        };
        refuse_unsupported(config)?;
        set_controls(config)?;
        let (capture, coding) = negotiate(config)?;
        let rate = config.settings.rate;
        let asked = Fract::new(1000, (rate * 1000.0).round().max(1.0) as u32);
        let taken = capture.set_frame_interval(asked).unwrap_or(asked);
        let interval = f64::from(taken.numerator()) / f64::from(taken.denominator().max(1));
        let stride = capture.format().bytes_per_line() as usize;
        let stream = capture.into_stream().map_err(failed("streaming"))?;
        Ok(Self {
            stream,
            name: config.device.display().to_string(),
            coding,
            size: config.settings.size,
            stride,
            clock: FrameClock::new(interval),
            opened: Instant::now(),
        })
    }
}

/// Refuses what the library cannot ask a camera for.
fn refuse_unsupported(config: &VideoConfig) -> Result<(), VideoError> {
    let refused = |what: String, reason: &str| {
        Err(VideoError::Setting {
            device: config.device.clone(),
            what,
            reason: reason.into(),
        })
    };
    if let Some((x, y)) = config.settings.offset {
        return refused(
            format!("a region from column {x}, row {y}"),
            "expected a GenICam camera; regions of Video4Linux cameras cannot be moved from here",
        );
    }
    match &config.settings.trigger {
        Trigger::Free => Ok(()),
        trigger => refused(
            format!("trigger {trigger}"),
            "expected a GenICam camera; Video4Linux cameras run freely",
        ),
    }
}

/// The first coding that the camera has in the size that is asked for.
fn negotiate(config: &VideoConfig) -> Result<(VideoCaptureDevice, Coding), VideoError> {
    let (width, height) = config.settings.size;
    let mut offered = Vec::new();
    for (coding, format) in Coding::ALL {
        let device = Device::open(&config.device).map_err(|source| VideoError::Device {
            device: config.device.clone(),
            what: "opening",
            source,
        })?;
        let asked = PixFormat::new(width as u32, height as u32, format);
        match device.video_capture(asked) {
            Ok(capture) => {
                let got = capture.format();
                let (columns, rows) = (got.width() as usize, got.height() as usize);
                let fourcc = got.pixel_format().as_fourcc();
                if (columns, rows) == (width, height) && fourcc == format.as_fourcc() {
                    return Ok((capture, coding));
                }
                let name = String::from_utf8_lossy(&fourcc).into_owned();
                offered.push(format!("{columns}x{rows} {name}"));
            }
            Err(error) => offered.push(error.to_string()),
        }
    }
    offered.dedup();
    Err(VideoError::Format {
        device: config.device.clone(),
        width,
        height,
        offered: offered.join(", "),
    })
}

impl Camera for VideoCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size(self.size, frame)?;
        let (coding, stride, picture) = (self.coding, self.stride, &mut frame.picture);
        let taken = self.stream.dequeue(|view| {
            if view.is_error() {
                return Ok(Err(
                    "the driver says that the picture is damaged".to_string()
                ));
            }
            Ok(unpack(coding, stride, &view, picture))
        });
        let taken = taken.map_err(|e| self.lost(&e))?;
        frame.stamp = self.opened.elapsed().as_secs_f64();
        frame.sequence = self.clock.sequence(frame.stamp);
        taken.map_err(|reason| CameraError::Unreadable {
            name: format!("{}, frame {}", self.name, frame.sequence),
            reason,
        })
    }
}

impl VideoCamera {
    /// Why there will be no further picture.
    fn lost(&self, error: &io::Error) -> CameraError {
        let unplugged = match error.raw_os_error() {
            Some(NO_SUCH_DEVICE) => "; the camera was unplugged",
            _ => "",
        };
        CameraError::Failed(format!("{}: {error}{unplugged}", self.name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_camera_is_refused() {
        let config = VideoConfig {
            device: "/dev/null".into(),
            settings: CameraSettings::new((640, 480), 30.0),
        };
        let refused = |config: &VideoConfig, words: &str| {
            let error = VideoCamera::open(config).err().expect("no camera");
            let error = error.to_string();
            assert!(
                error.contains("/dev/null") && error.contains(words),
                "{error}"
            );
        };
        refused(&config, "expected a Video4Linux camera");
        let mut moved = config.clone();
        moved.settings.offset = Some((8, 16));
        refused(&moved, "a region from column 8, row 16");
        let mut triggered = config;
        triggered.settings.trigger = Trigger::Software;
        refused(&triggered, "trigger software: expected a GenICam camera");
    }
}
