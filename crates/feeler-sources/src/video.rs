//! A Video4Linux camera.
//!
//! Its pictures are taken as grey (`GREY`), as the luma of `YUYV`, or as Motion JPEG, in this order
//! of preference. A camera that has none of the wanted size takes larger ones, which are scaled down ([`Fit`]).

mod buffer;
mod choice;
mod clock;
mod coding;
mod controls;
mod error;
mod list;

pub use error::VideoError;
pub use list::{VideoControl, VideoFormat, VideoInfo, VideoListed, VideoSize, list};

use crate::fit::Fit;
use crate::settings::{CameraSettings, Trigger};
use buffer::StreamBuffers;
use choice::{Candidate, candidates, choose};
use clock::FrameClock;
use coding::{Coding, Decoder};
use controls::set_controls;
use feeler::sensor::camera::{Camera, CameraError, CaptureReport, check_frame_size};
use feeler::sensor::frame::Frame;
use linuxvideo::format::PixFormat;
use linuxvideo::stream::ReadStream;
use linuxvideo::{Device, Fract, VideoCaptureDevice};
use rustix::time::{ClockId, clock_gettime};
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
/// Stamps are the driver's, of the monotonic clock, in seconds since the camera was opened; sequence numbers are the driver's, and a gap is a
/// frame that was dropped. A stamp that cannot be true (missing, of another clock, in the future, older than the picture can be, not later
/// than the one before) is replaced by the time of arrival, and a number that cannot be true by counting intervals between arrivals; the
/// first time, the report of the picture has a warning.
pub struct VideoCamera {
    // Before the buffers, whose they are.
    stream: ReadStream,
    buffers: StreamBuffers,
    name: String,
    decoder: Decoder,
    size: (usize, usize),
    clock: FrameClock,
    opened: Instant,
    report: CaptureReport,
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
        let (capture, coding, fit) = negotiate(config)?;
        let rate = config.settings.rate;
        let asked = Fract::new(1000, (rate * 1000.0).round().max(1.0) as u32);
        let taken = capture.set_frame_interval(asked).unwrap_or(asked);
        let interval = f64::from(taken.numerator()) / f64::from(taken.denominator().max(1));
        let stride = capture.format().bytes_per_line() as usize;
        // The driver's clock is the one of `Instant`.
        let (opened, by_driver) = (Instant::now(), clock_gettime(ClockId::Monotonic));
        let by_driver = by_driver.tv_sec as f64 + 1e-9 * by_driver.tv_nsec as f64;
        let stream = capture.into_stream().map_err(failed("streaming"))?;
        let buffers = StreamBuffers::of(&stream).map_err(failed("streaming"))?;
        Ok(Self {
            stream,
            buffers,
            name: config.device.display().to_string(),
            decoder: Decoder::new(coding, stride, fit),
            size: config.settings.size,
            clock: FrameClock::new(by_driver, interval),
            opened,
            report: CaptureReport::default(),
        })
    }

    /// When the camera was opened: the time at which its stamps are 0.
    pub fn opened(&self) -> Instant {
        self.opened
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

/// The first coding that the camera has in the size that is asked for, or else the one that is best scaled to it.
fn negotiate(config: &VideoConfig) -> Result<(VideoCaptureDevice, Coding, Fit), VideoError> {
    let wanted = config.settings.size;
    let mut offered = Vec::new();
    let mut others = Vec::new();
    for coding in Coding::ALL {
        match ask(config, coding, wanted)? {
            Asked::Given(capture, fit) => return Ok((capture, coding, fit)),
            Asked::Other(words, candidate) => {
                offered.push(words);
                others.extend(candidate);
            }
        }
    }
    if let Ok(Some(info)) = list::info(&config.device) {
        others.extend(candidates(&info.formats));
    }
    match choose(&others, wanted, config.settings.rate) {
        Ok((Candidate { coding, size, .. }, fit)) => match ask(config, coding, size)? {
            Asked::Given(capture, _) => return Ok((capture, coding, fit)),
            Asked::Other(words, _) => offered.push(words),
        },
        Err(Some(why)) => offered.push(why.to_string()),
        Err(None) => {}
    }
    offered.dedup();
    Err(VideoError::Format {
        device: config.device.clone(),
        width: wanted.0,
        height: wanted.1,
        offered: offered.join(", "),
    })
}

/// What comes of asking a driver for a format.
enum Asked {
    /// It is set.
    Given(VideoCaptureDevice, Fit),
    /// What the driver would do instead, in words and, where that can be decoded, for choosing.
    Other(String, Option<Candidate>),
}

/// Asks the driver for pictures of `coding` and `size`.
fn ask(config: &VideoConfig, coding: Coding, size: (usize, usize)) -> Result<Asked, VideoError> {
    let device = Device::open(&config.device).map_err(|source| VideoError::Device {
        device: config.device.clone(),
        what: "opening",
        source,
    })?;
    let pixels = coding.pixels();
    let capture = match device.video_capture(PixFormat::new(size.0 as u32, size.1 as u32, pixels)) {
        Ok(capture) => capture,
        Err(error) => return Ok(Asked::Other(error.to_string(), None)),
    };
    let got = capture.format();
    let found = (got.width() as usize, got.height() as usize);
    let fourcc = got.pixel_format().as_fourcc();
    let is_coding = fourcc == pixels.as_fourcc();
    if let (true, true, Ok(fit)) = (is_coding, found == size, Fit::new(found, size)) {
        return Ok(Asked::Given(capture, fit));
    }
    let words = format!(
        "{}x{} {}",
        found.0,
        found.1,
        String::from_utf8_lossy(&fourcc)
    );
    let candidate = is_coding.then_some(Candidate {
        coding,
        size: found,
        rate: None,
    });
    Ok(Asked::Other(words, candidate))
}

impl Camera for VideoCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size(self.size, frame)?;
        let (buffers, decoder, opened) = (&self.buffers, &mut self.decoder, self.opened);
        let picture = &mut frame.picture;
        let taken = self.stream.dequeue(|view| {
            let arrival = opened.elapsed();
            let stamp = buffers.dequeued();
            let decoded = match view.is_error() {
                true => Err("the driver says that the picture is damaged".to_string()),
                false => decoder.decode(&view, picture),
            };
            let decoding = opened.elapsed().saturating_sub(arrival);
            Ok((arrival, stamp, decoded, view.len(), decoding))
        });
        let (arrival, stamp, taken, bytes, decoding) = taken.map_err(|e| self.lost(&e))?;
        let stamped = self.clock.stamp(stamp, arrival.as_secs_f64());
        (frame.stamp, frame.sequence) = (stamped.stamp, stamped.sequence);
        self.report = CaptureReport {
            bytes: Some(bytes),
            decoding: Some(decoding),
            warning: stamped.warning,
        };
        taken.map_err(|reason| CameraError::Unreadable {
            name: format!("{}, frame {}", self.name, frame.sequence),
            reason,
        })
    }

    fn take_report(&mut self) -> CaptureReport {
        std::mem::take(&mut self.report)
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
