//! A Video4Linux camera.
//!
//! Its pictures are taken as grey (`GREY`), as the luma of `YUYV`, or as Motion JPEG, in this order
//! of preference.

use super::picture::decode_picture;
use crate::sensor::camera::{Camera, CameraError, check_frame_size};
use crate::sensor::frame::{Frame, Picture};
use linuxvideo::format::{PixFormat, PixelFormat};
use linuxvideo::stream::ReadStream;
use linuxvideo::{Device, Fract, VideoCaptureDevice};
use std::io;
use std::path::PathBuf;
use std::time::Instant;

/// Names of the control that sets the exposure time, in units of 100 us.
const EXPOSURE_CONTROLS: [&str; 2] = ["Exposure Time, Absolute", "Exposure (Absolute)"];
/// Names of the control that must be [`MANUAL_EXPOSURE`] for that.
const AUTO_EXPOSURE_CONTROLS: [&str; 2] = ["Auto Exposure", "Exposure, Auto"];
/// `V4L2_EXPOSURE_MANUAL`.
const MANUAL_EXPOSURE: i32 = 1;
/// Exposure time's unit, s.
const EXPOSURE_UNIT: f64 = 1e-4;

/// What the system says of a device that is gone (`ENODEV`).
const NO_SUCH_DEVICE: i32 = 19;

/// Which camera, and how it is set.
#[derive(Debug, Clone, PartialEq)]
pub struct VideoConfig {
    /// The device, as in `/dev/video0`.
    pub device: PathBuf,
    /// Columns and rows of the pictures, px.
    pub size: (usize, usize),
    /// Frames per second, Hz, that are asked for; the camera takes the nearest that it can.
    pub rate: f64,
    /// Exposure time, s; as the camera is set if none.
    pub exposure: Option<f64>,
}

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
    /// The exposure time cannot be set.
    #[error("{}: the exposure time cannot be set to {exposure} s: {reason}", device.display())]
    Exposure {
        /// The device.
        device: PathBuf,
        /// What was asked for, s.
        exposure: f64,
        /// What is missing or out of range.
        reason: String,
    },
}

/// How the camera codes its pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Coding {
    Gray,
    Yuyv,
    MotionJpeg,
}

impl Coding {
    const ALL: [(Self, PixelFormat); 3] = [
        (Self::Gray, PixelFormat::from_fourcc(*b"GREY")),
        (Self::Yuyv, PixelFormat::YUYV),
        (Self::MotionJpeg, PixelFormat::MJPG),
    ];
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
        if let Some(exposure) = config.exposure {
            set_exposure(config, exposure)?;
        }
        let (capture, coding) = negotiate(config)?;
        let asked = Fract::new(1000, (config.rate * 1000.0).round().max(1.0) as u32);
        let taken = capture.set_frame_interval(asked).unwrap_or(asked);
        let interval = f64::from(taken.numerator()) / f64::from(taken.denominator().max(1));
        let stride = capture.format().bytes_per_line() as usize;
        let stream = capture.into_stream().map_err(failed("streaming"))?;
        Ok(Self {
            stream,
            name: config.device.display().to_string(),
            coding,
            size: config.size,
            stride,
            clock: FrameClock::new(interval),
            opened: Instant::now(),
        })
    }
}

/// The first coding that the camera has in the size that is asked for.
fn negotiate(config: &VideoConfig) -> Result<(VideoCaptureDevice, Coding), VideoError> {
    let (width, height) = config.size;
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
                if (columns, rows) == config.size && fourcc == format.as_fourcc() {
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

fn set_exposure(config: &VideoConfig, exposure: f64) -> Result<(), VideoError> {
    let refused = |reason: String| VideoError::Exposure {
        device: config.device.clone(),
        exposure,
        reason,
    };
    let set = || -> Result<(), String> {
        let mut device = Device::open(&config.device).map_err(|e| e.to_string())?;
        let controls: Vec<_> = device.controls().filter_map(Result::ok).collect();
        let control = |names: [&str; 2]| controls.iter().find(|c| names.contains(&c.name()));
        let time = control(EXPOSURE_CONTROLS).ok_or("the camera has no such control")?;
        let value = exposure_steps(exposure, time.minimum(), time.maximum())?;
        if let Some(automatic) = control(AUTO_EXPOSURE_CONTROLS) {
            let written = device.write_control_raw(automatic.id(), MANUAL_EXPOSURE);
            written.map_err(|e| e.to_string())?;
        }
        let written = device.write_control_raw(time.id(), value);
        written.map_err(|e| e.to_string())
    };
    set().map_err(refused)
}

/// An exposure time (s) in the control's unit, if it lies within its range.
fn exposure_steps(exposure: f64, low: i32, high: i32) -> Result<i32, String> {
    let steps = (exposure / EXPOSURE_UNIT).round();
    if (f64::from(low)..=f64::from(high)).contains(&steps) {
        return Ok(steps as i32);
    }
    let [low, high] = [low, high].map(|limit| f64::from(limit) * EXPOSURE_UNIT);
    Err(format!("expected {low:.4} to {high:.4} s"))
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

/// Numbers frames by when they arrive.
#[derive(Debug)]
struct FrameClock {
    interval: f64,
    last: Option<(u64, f64)>,
}

impl FrameClock {
    fn new(interval: f64) -> Self {
        Self {
            interval,
            last: None,
        }
    }

    /// The number of a frame that arrives at `stamp`, s.
    fn sequence(&mut self, stamp: f64) -> u64 {
        let sequence = self.last.map_or(0, |(sequence, before)| {
            let intervals = ((stamp - before) / self.interval).round();
            // A cast saturates: an interval of 0 s or none at all gives the next number.
            sequence.saturating_add((intervals as u64).clamp(1, u64::from(u32::MAX)))
        });
        self.last = Some((sequence, stamp));
        sequence
    }
}

/// Puts the camera's bytes into `picture`.
fn unpack(
    coding: Coding,
    stride: usize,
    bytes: &[u8],
    picture: &mut Picture,
) -> Result<(), String> {
    let (width, height) = (picture.width, picture.height);
    let bytes_per_pixel = match coding {
        Coding::Gray => 1,
        Coding::Yuyv => 2,
        Coding::MotionJpeg => {
            let decoded = decode_picture(bytes).map_err(|e| e.to_string())?;
            if (decoded.width, decoded.height) != (width, height) {
                let (columns, rows) = (decoded.width, decoded.height);
                return Err(format!(
                    "{width}x{height} px expected, got {columns}x{rows} px"
                ));
            }
            *picture = decoded;
            return Ok(());
        }
    };
    let row_bytes = width * bytes_per_pixel;
    let stride = stride.max(row_bytes);
    let expected = stride * height.saturating_sub(1) + row_bytes;
    if bytes.len() < expected {
        return Err(format!("{expected} bytes expected, got {}", bytes.len()));
    }
    let rows = picture.pixels.chunks_exact_mut(width.max(1));
    for (row, bytes) in rows.zip(bytes.chunks(stride)) {
        for (pixel, value) in row.iter_mut().zip(bytes.iter().step_by(bytes_per_pixel)) {
            *pixel = *value;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_taken_without_their_padding_and_colours() {
        let mut picture = Picture::black(2, 2);
        let gray = [1, 2, 99, 3, 4];
        assert_eq!(unpack(Coding::Gray, 3, &gray, &mut picture), Ok(()));
        assert_eq!(picture.pixels, [1, 2, 3, 4]);
        let yuyv = [5, 99, 6, 99, 7, 99, 8, 99];
        assert_eq!(unpack(Coding::Yuyv, 4, &yuyv, &mut picture), Ok(()));
        assert_eq!(picture.pixels, [5, 6, 7, 8]);
        assert!(unpack(Coding::Gray, 3, &gray[..4], &mut picture).is_err());
        assert!(unpack(Coding::MotionJpeg, 0, &gray, &mut picture).is_err());
    }

    #[test]
    fn a_late_frame_leaves_a_gap() {
        let mut clock = FrameClock::new(0.01);
        let stamps = [0.5, 0.51, 0.5198, 0.5502, 0.5502];
        assert_eq!(stamps.map(|stamp| clock.sequence(stamp)), [0, 1, 2, 5, 6]);
        let mut stopped = FrameClock::new(0.0);
        assert_eq!([0.0, 0.0].map(|stamp| stopped.sequence(stamp)), [0, 1]);
    }

    #[test]
    fn exposure_is_refused_beyond_the_control() {
        assert_eq!(exposure_steps(0.01, 1, 5000), Ok(100));
        assert!(exposure_steps(1.0, 1, 5000).is_err());
        assert!(exposure_steps(f64::NAN, 1, 5000).is_err());
    }

    #[test]
    fn what_is_no_camera_is_refused() {
        let config = VideoConfig {
            device: "/dev/null".into(),
            size: (640, 480),
            rate: 30.0,
            exposure: None,
        };
        let error = VideoCamera::open(&config).err().expect("no camera");
        assert!(error.to_string().contains("/dev/null"), "{error}");
    }
}
