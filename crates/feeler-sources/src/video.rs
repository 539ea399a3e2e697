//! Video4Linux cameras.
//!
//! Images are read as grey (`GREY`), as the luma of `YUYV`, or as Motion JPEG, in this order of preference. If the
//! camera does not offer the wanted size, larger images are scaled down ([`Fit`]).

mod buffer;
mod choice;
mod clock;
mod coding;
mod controls;
mod error;
mod list;

pub use error::VideoError;
pub use list::{ListedDevice, VideoControl, VideoFormat, VideoInfo, VideoSize, list};

use crate::fit::Fit;
use crate::settings::{CameraSettings, Trigger};
use buffer::StreamBuffers;
use choice::{Candidate, candidates, choose};
use clock::FrameClock;
use coding::{Coding, Decoder};
use controls::set_controls;
use feeler::sensor::image::{Camera, CameraError, CaptureReport, Frame, check_frame_size};
use linuxvideo::format::PixFormat;
use linuxvideo::stream::ReadStream;
use linuxvideo::{Device, Fract, VideoCaptureDevice};
use rustix::time::{ClockId, clock_gettime};
use std::io;
use std::path::PathBuf;
use std::time::Instant;

/// Error code of an unplugged device (`ENODEV`).
const NO_SUCH_DEVICE: i32 = 19;

/// Device and its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct VideoConfig {
    /// Path of the device, as in `/dev/video0`.
    pub device: PathBuf,
    /// Settings to apply. Offsets and triggers are not supported by the library `linuxvideo` and are rejected.
    pub settings: CameraSettings,
}

/// A free-running Video4Linux camera.
///
/// Stamps come from the driver's monotonic clock, in seconds since the camera was opened. Sequence numbers come from
/// the driver; a gap means dropped frames. An implausible stamp (missing, of another clock, in the future, older than
/// the image can be, or not later than the previous one) is replaced by the arrival time. An implausible number is
/// replaced by counting intervals between arrivals. The first time, the report of the image contains a warning.
pub struct VideoCamera {
    // Dropped before the buffers that it uses.
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
    /// Opens and configures the camera, and starts capturing.
    ///
    /// # Errors
    /// If the device is not a camera or rejects a setting in `config`.
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
        // The driver uses the same clock as `Instant`.
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

    /// Time at which the camera was opened, which is stamp 0.
    pub fn opened(&self) -> Instant {
        self.opened
    }
}

/// Rejects settings that the library does not support.
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
            "expected a GenICam camera; the region of a Video4Linux camera cannot be moved",
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

/// Opens the camera with the first coding that it offers in the wanted size, otherwise with the format that is best for
/// scaling to it.
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

/// Result of requesting a format from a driver.
enum Asked {
    /// The format is set.
    Given(VideoCaptureDevice, Fit),
    /// The driver offers another format: its description, and the candidate if it can be decoded.
    Other(String, Option<Candidate>),
}

/// Requests images of `coding` and `size` from the driver.
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
                true => Err("the driver reports a damaged image".to_string()),
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
    /// Returns the error for a device that delivers no further images.
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
    fn invalid_devices_and_unsupported_settings_are_refused() {
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
