//! GenICam cameras (GigE Vision, USB3 Vision) through [Aravis](https://github.com/AravisProject/aravis), which is
//! loaded at run time.
//!
//! Images are read as `Mono8`, or if the camera does not have that, as `Mono10`, `Mono12` or `Mono16`, scaled to 8
//! bits. Packed formats and colours are not supported.

mod aravis;
mod clock;
mod error;
mod info;
mod list;
mod pixels;
mod set;

pub use error::GenicamError;
pub use info::{Abilities, GenicamDevice, GenicamInfo, Range};
pub use list::list;

use crate::settings::{CameraSettings, Trigger};
use aravis::device::Device;
use aravis::stream::Stream;
use aravis::{Aravis, FAKE};
use clock::{DeviceClock, FrameCounter};
use feeler::sensor::image::{Camera, CameraError, CaptureReport, Frame, check_frame_size};
use pixels::Pixels;
use std::time::{Duration, Instant};

/// Number of images buffered before the camera drops some.
const BUFFERS: usize = 8;
/// Time without an image after which the camera is checked for a response.
const LOOK: Duration = Duration::from_secs(1);
/// Time without an image, beyond the usual frame time, after which a free-running camera that still responds has
/// failed.
const SILENCE: Duration = Duration::from_secs(10);

/// Camera and its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct GenicamConfig {
    /// Id as returned by [`list`], serial number or address; `None` for the first camera that responds. `Fake_1` is a
    /// camera that Aravis simulates.
    pub id: Option<String>,
    /// Settings to apply.
    pub settings: CameraSettings,
}

/// A GenICam camera that is capturing.
///
/// Stamps are the camera's exposure times, mapped onto the host's monotonic clock (s since the camera was opened).
/// The clocks' offset is the smallest difference between arrival and camera time in the last seconds, so stamps
/// include the latency of the fastest image. Stamps never decrease and are never later than the arrival. Sequence
/// numbers come from the camera's frame counter; a gap counts images that did not reach the host. Images are returned
/// in order.
pub struct GenicamCamera {
    // Dropped before the device that owns it.
    stream: Stream,
    device: Device,
    name: String,
    pixels: Pixels,
    settings: CameraSettings,
    clock: DeviceClock,
    counter: FrameCounter,
    opened: Instant,
    /// Time at which the next image is triggered by software.
    due: Instant,
    report: CaptureReport,
}

impl GenicamCamera {
    /// Opens and configures the camera, and starts capturing.
    ///
    /// # Errors
    /// If Aravis cannot be loaded, the camera is not found, or it rejects a setting in `config`.
    pub fn open(config: &GenicamConfig) -> Result<Self, GenicamError> {
        let aravis = Aravis::load().map_err(|reason| GenicamError::Library { reason })?;
        let id = config.id.as_deref();
        if id.is_some_and(|id| id.starts_with(FAKE)) {
            aravis.enable_fake();
        }
        let device = Device::open(aravis, id).map_err(|reason| GenicamError::NotFound {
            id: id.unwrap_or_default().into(),
            reason,
            listed: list::ids(aravis),
        })?;
        let name = match id {
            Some(id) => format!("genicam:{id}"),
            None => name_of(&device),
        };
        let failed = |what| {
            let camera = name.clone();
            move |reason| GenicamError::Device {
                camera,
                what,
                reason,
            }
        };
        if !device.obeys() {
            return Err(failed("setting")("another program uses it".into()));
        }
        let pixels = set::apply(&device, &name, &config.settings)?;
        let stream = device.stream(BUFFERS).map_err(failed("streaming"))?;
        device.start().map_err(failed("starting"))?;
        let opened = Instant::now();
        Ok(Self {
            stream,
            device,
            name,
            pixels,
            settings: config.settings.clone(),
            clock: DeviceClock::default(),
            counter: FrameCounter::default(),
            opened,
            due: opened,
            report: CaptureReport::default(),
        })
    }

    /// Time at which the camera was opened, which is stamp 0.
    pub fn opened(&self) -> Instant {
        self.opened
    }

    /// Waits until the next image is due and triggers it, if the trigger is `Software`.
    fn trigger(&mut self) -> Result<(), CameraError> {
        if self.settings.trigger != Trigger::Software {
            return Ok(());
        }
        std::thread::sleep(self.due.saturating_duration_since(Instant::now()));
        self.due = self.due.max(Instant::now()) + Duration::from_secs_f64(1.0 / self.settings.rate);
        self.device
            .trigger()
            .map_err(|reason| CameraError::Failed(format!("{}: {reason}", self.name)))
    }

    /// Error for an image that has not arrived after `waited`, or `None` to continue waiting.
    fn absence(&self, waited: Duration) -> Option<CameraError> {
        if let Err(reason) = self.device.answers() {
            return Some(CameraError::Failed(format!(
                "{}: the camera does not respond: {reason}",
                self.name
            )));
        }
        let exposure = self.settings.exposure.unwrap_or_default();
        let usual = Duration::from_secs_f64(exposure + 1.0 / self.settings.rate);
        if waited < SILENCE + usual {
            return None;
        }
        let seconds = waited.as_secs();
        match self.settings.trigger {
            // An external signal has no time limit.
            Trigger::Line(_) => None,
            Trigger::Software => Some(CameraError::Unreadable {
                name: self.name.clone(),
                reason: format!("no image for {seconds} s after the trigger"),
            }),
            Trigger::Free => Some(CameraError::Failed(format!(
                "{}: no image for {seconds} s, although the camera responds",
                self.name
            ))),
        }
    }
}

/// Name of a camera opened without an id.
fn name_of(device: &Device) -> String {
    match device.names() {
        Ok([vendor, model, id]) => format!("genicam: ({vendor} {model} {id})"),
        Err(_) => "genicam:".into(),
    }
}

impl Camera for GenicamCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size(self.settings.size, frame)?;
        self.trigger()?;
        let began = Instant::now();
        let (width, height) = self.settings.size;
        loop {
            let Some(buffer) = self.stream.next(LOOK) else {
                match self.absence(began.elapsed()) {
                    Some(error) => return Err(error),
                    None => continue,
                }
            };
            let arrival = self.opened.elapsed().as_secs_f64();
            let id = buffer.frame_id();
            let unreadable = |reason: String| CameraError::Unreadable {
                name: format!("{}, frame {id} of the camera", self.name),
                reason,
            };
            // Incomplete images may arrive after later ones, and may have no valid stamp.
            if let Some(fault) = buffer.fault() {
                return Err(unreadable(fault.into()));
            }
            let Some(sequence) = self.counter.sequence(id) else {
                return Err(unreadable("it came after a later one".into()));
            };
            frame.sequence = sequence;
            frame.stamp = self.clock.stamp(buffer.timestamp(), arrival);
            let (size, code) = (buffer.size(), buffer.pixel_format());
            if size != [width as i32, height as i32] || code != self.pixels.code() {
                let [columns, rows] = size;
                let expected = self.pixels.name();
                return Err(unreadable(format!(
                    "expected {width}x{height} px of {expected}, got {columns}x{rows} px of format {code:#010x}"
                )));
            }
            let (bytes, began) = (buffer.bytes(), Instant::now());
            let unpacked = self.pixels.unpack(bytes, &mut frame.picture);
            self.report = CaptureReport {
                bytes: Some(bytes.len()),
                decoding: Some(began.elapsed()),
                warning: None,
            };
            return unpacked.map_err(unreadable);
        }
    }

    fn take_report(&mut self) -> CaptureReport {
        std::mem::take(&mut self.report)
    }
}

impl Drop for GenicamCamera {
    fn drop(&mut self) {
        // An unplugged camera need not be stopped.
        let _ = self.device.stop();
    }
}
