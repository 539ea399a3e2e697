//! GenICam cameras (GigE Vision, USB3 Vision) by [Aravis](https://github.com/AravisProject/aravis), which is loaded at run time.
//!
//! Pictures are taken as `Mono8`, or where a camera does not have that, as `Mono10`, `Mono12` or `Mono16`, scaled to 8 bits. Packed
//! formats and colours are not supported.

mod aravis;
mod clock;
mod error;
mod list;
mod pixels;
mod set;

pub use error::GenicamError;
pub use list::{Abilities, GenicamDevice, GenicamInfo, Range, list};

use crate::settings::{CameraSettings, Trigger};
use aravis::{Aravis, Device, Stream};
use clock::{DeviceClock, FrameCounter};
use feeler::sensor::camera::{Camera, CameraError, CaptureReport, check_frame_size};
use feeler::sensor::frame::Frame;
use pixels::Pixels;
use std::time::{Duration, Instant};

/// Pictures that the camera may have ready before it drops some.
const BUFFERS: usize = 8;
/// After so long without a picture the camera is asked whether it is still there.
const LOOK: Duration = Duration::from_secs(1);
/// A freely running camera that answers and sends nothing has failed after so long beyond the time that a picture takes.
const SILENCE: Duration = Duration::from_secs(10);
/// Beginning of the ids of the cameras that Aravis simulates.
const FAKE: &str = "Fake_";

/// Which camera, and how it is set.
#[derive(Debug, Clone, PartialEq)]
pub struct GenicamConfig {
    /// Its id as [`list`] has it, its serial number or its address; the first camera that answers if none. `Fake_1` is a camera
    /// that Aravis simulates.
    pub id: Option<String>,
    /// How it is set.
    pub settings: CameraSettings,
}

/// A GenICam camera that takes pictures.
///
/// Stamps are the camera's own times of exposure, mapped onto the host's monotonic clock since the camera was opened by the least
/// difference between arrival and camera's time in the last seconds: that of the fastest picture. They include what that one took
/// on its way, never go back, and are never later than the arrival. Sequence numbers are the camera's frame counter; a gap is what
/// the camera took and the host did not get. Pictures are delivered in their order.
pub struct GenicamCamera {
    // Before the device, whose it is.
    stream: Stream,
    device: Device,
    name: String,
    pixels: Pixels,
    settings: CameraSettings,
    clock: DeviceClock,
    counter: FrameCounter,
    opened: Instant,
    /// When the next picture is triggered by software.
    due: Instant,
    report: CaptureReport,
}

impl GenicamCamera {
    /// Opens and sets the camera, and starts it.
    ///
    /// # Errors
    /// When Aravis or the camera is not there, or it cannot be set as `config` says.
    pub fn open(config: &GenicamConfig) -> Result<Self, GenicamError> {
        let aravis = Aravis::load().map_err(|reason| GenicamError::Library { reason })?;
        let id = config.id.as_deref();
        if id.is_some_and(|id| id.starts_with(FAKE)) {
            aravis.enable_fake();
        }
        let device = aravis.open(id).map_err(|reason| GenicamError::NotFound {
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
            return Err(failed("setting")("another program has it".into()));
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

    /// When the camera was opened: the time at which its stamps are 0.
    pub fn opened(&self) -> Instant {
        self.opened
    }

    /// Triggers the next picture, once it is due.
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

    /// Why no picture came after `waited`; none to go on waiting.
    fn absence(&self, waited: Duration) -> Option<CameraError> {
        if let Err(reason) = self.device.answers() {
            return Some(CameraError::Failed(format!(
                "{}: the camera does not answer: {reason}",
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
            // The next signal may come whenever it comes.
            Trigger::Line(_) => None,
            Trigger::Software => Some(CameraError::Unreadable {
                name: self.name.clone(),
                reason: format!("no picture for {seconds} s after it was triggered"),
            }),
            Trigger::Free => Some(CameraError::Failed(format!(
                "{}: no picture for {seconds} s, though the camera answers",
                self.name
            ))),
        }
    }
}

/// A camera's own name for itself.
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
            // One that is not whole may come after later ones, and its stamp may be none.
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
                    "{width}x{height} px of {expected} expected, got {columns}x{rows} px of format {code:#010x}"
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
        // One that is gone does not need it.
        let _ = self.device.stop();
    }
}
