//! Guided calibration: a person presses the fingertip on a force sensor under a camera.

mod elements;
mod folder;
mod force;
mod guide;
mod screen;
mod whole;

use crate::camera::{CameraName, CameraOptions, NAMES, OpenCamera};
use elements::Elements;
use feeler::sensor::calibration_fit::ModelChoice;
use feeler::sensor::camera::CameraError;
use feeler::sensor::frame::{Frame, Picture};
use feeler::sensor::live_calibration::{ForceAxes, Goal, Wrench};
use feeler::sensor::moments::ElementMoments;
use feeler_console::{CommandError, watch_for_interrupt};
use feeler_lab::sensor::SensorGeometry;
use feeler_sources::netft::ForceSample;
use feeler_sources::pump::{Captured, FramePump};
use feeler_sources::raw::RawFrames;
use folder::Folder;
pub use force::ForceAddress;
use force::ForceSensor;
use glam::DVec3;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use whole::Whole;

/// Name of the table of loads on single elements.
pub const LOADS: &str = "LOADS.csv";
/// Name of the table of wrenches on the whole fingertip.
pub const FORCES: &str = "FORCES.csv";

/// Pictures that wait for their forces at most: half a second's of a fast camera.
const WAITING: usize = 32;
/// How long to wait for a picture before looking at forces and Ctrl-C.
const WAIT: Duration = Duration::from_millis(20);

/// Camera and force sensor of a guided calibration, and what it calibrates.
pub struct GuideOptions<'a> {
    /// Camera, or `-` for raw grey frames on standard input.
    pub camera: &'a Path,
    /// Frame rate requested from the camera (Hz).
    pub rate: f64,
    /// Camera settings.
    pub settings: CameraOptions,
    /// Force sensor under the fingertip.
    pub force_sensor: &'a ForceAddress,
    /// Conversion from the axes of the force sensor to those of the fingertip.
    pub axes: ForceAxes,
    /// Compression and shear to reach.
    pub goal: Goal,
    /// Model to fit to single elements; `None` to calibrate the wrench on the whole fingertip.
    pub model: Option<ModelChoice>,
}

impl GuideOptions<'_> {
    fn open(&self, size: (usize, usize)) -> Result<OpenCamera, CommandError> {
        let camera = self.camera;
        if camera == Path::new("-") {
            return Ok(OpenCamera {
                camera: Box::new(RawFrames::new(std::io::stdin(), size, self.rate)),
                exposed_since: None,
            });
        }
        let Some(name) = CameraName::parse(camera) else {
            let camera = camera.display();
            return Err(format!("--live {camera}: expected a camera, {NAMES}, or -").into());
        };
        name.open(self.settings.settings(size, self.rate))
    }
}

/// What a person does: which loads are wanted, and what is kept of them.
trait Work {
    /// Takes a load on the fingertip, in its frame, at a time, s.
    fn load(&mut self, at: f64, load: Wrench);
    /// Whether loads are known for as long as a picture of that time needs.
    fn is_ready(&self, at: f64) -> bool;
    /// Takes a picture of that time, and its moments.
    fn picture(
        &mut self,
        at: f64,
        picture: &Picture,
        moments: &[ElementMoments],
    ) -> Result<(), CommandError>;
    /// Shows how far it is.
    fn show(&mut self);
    /// Says that something is wrong which may pass.
    fn warn(&mut self, what: &str);
    /// Takes it off the screen.
    fn end(&self);
    /// What is kept.
    fn kept(&self) -> &Folder;
    /// What is missing, in words; none if nothing is.
    fn missing(&self) -> Option<String>;
}

/// Guides through the loads until the folder has all that is needed, or Ctrl-C.
///
/// # Errors
/// When the camera ends, or the folder cannot be written to; what was kept is there all the same, as after Ctrl-C.
pub fn guide(
    options: &GuideOptions<'_>,
    folder: &Path,
    sensor: &SensorGeometry,
) -> Result<(), CommandError> {
    let work: Box<dyn Work + '_> = match options.model {
        None => Box::new(Whole::open(folder, sensor, options.goal)?),
        Some(model) => Box::new(Elements::open(folder, sensor, options.goal, model)?),
    };
    let began = Instant::now();
    let forces = ForceSensor::connect(options.force_sensor)?;
    let OpenCamera {
        camera,
        exposed_since,
    } = options.open(sensor.size)?;
    let pump = FramePump::start(camera, sensor.size)?;
    let interrupted = watch_for_interrupt()?;
    let mut guided = Guided {
        sensor,
        axes: options.axes,
        began,
        exposed_since,
        waiting: VecDeque::new(),
        moments: vec![ElementMoments::default(); sensor.kernel.element_count()],
        work,
    };
    let ended = guided.run(&forces, &pump, &interrupted);
    guided.work.end();
    let missing = guided.work.missing();
    if ended.is_ok() && missing.is_none() {
        return Ok(());
    }
    let why = ended
        .err()
        .map_or_else(|| "interrupted".to_string(), |e| e.to_string());
    let missing = missing.unwrap_or_else(|| "nothing is missing".into());
    let (kept, place) = (guided.work.kept(), folder.display());
    let wrench = if options.model.is_none() {
        " --wrench"
    } else {
        ""
    };
    Err(format!(
        "{why}: {} pictures are kept in {place}, and {missing}; the same command goes on from there, and `feeler calibrate {}{wrench}` \
         calibrates by what there is",
        kept.pictures(),
        kept.table().display()
    )
    .into())
}

/// A person at work.
struct Guided<'a> {
    sensor: &'a SensorGeometry,
    axes: ForceAxes,
    began: Instant,
    /// When the camera's stamps were 0, if they are times of exposure.
    exposed_since: Option<Instant>,
    /// Pictures that wait for the forces of their time.
    waiting: VecDeque<(f64, Frame)>,
    moments: Vec<ElementMoments>,
    work: Box<dyn Work + 'a>,
}

impl Guided<'_> {
    fn run(
        &mut self,
        forces: &ForceSensor,
        pump: &FramePump,
        interrupted: &AtomicBool,
    ) -> Result<(), CommandError> {
        while self.work.missing().is_some() && !interrupted.load(Ordering::Relaxed) {
            let captured = pump.next(WAIT);
            loop {
                match forces.next_sample() {
                    Ok(Some(sample)) => self.force(&sample),
                    Ok(None) => break,
                    Err(error) => self.work.warn(&error.to_string()),
                }
            }
            if let Some(Captured { frame, at, report }) = captured {
                if let Some(warning) = &report.warning {
                    self.work.warn(warning);
                }
                match frame {
                    Ok(frame) => self.waiting.push_back((self.time_of(&frame, at), frame)),
                    Err(error) if error.may_pass() => self.work.warn(&error.to_string()),
                    Err(CameraError::Ended { .. }) => return Err("the camera has ended".into()),
                    Err(error) => return Err(error.into()),
                }
            }
            self.pictures(pump)?;
            self.work.show();
        }
        Ok(())
    }

    /// Takes the pictures whose forces are known, and the oldest where too many wait.
    fn pictures(&mut self, pump: &FramePump) -> Result<(), CommandError> {
        while let Some(&(at, _)) = self.waiting.front()
            && (self.work.is_ready(at) || self.waiting.len() > WAITING)
            && let Some((at, frame)) = self.waiting.pop_front()
        {
            let picture = &frame.picture;
            self.sensor.kernel.measure(picture, &mut self.moments)?;
            self.work.picture(at, picture, &self.moments)?;
            pump.give_back(frame);
        }
        Ok(())
    }

    /// Seconds on the clock of forces and pictures.
    fn time(&self, at: Instant) -> f64 {
        at.saturating_duration_since(self.began).as_secs_f64()
    }

    fn force(&mut self, sample: &ForceSample) {
        let [x, y, z, a, b, c] = sample.wrench;
        let load = Wrench {
            force: self.axes.to_fingertip(DVec3::new(x, y, z)),
            torque: self.axes.to_fingertip(DVec3::new(a, b, c)),
        };
        self.work.load(self.time(sample.at), load);
    }

    /// The time that a picture is of: its stamp, if that tells, or when it came in.
    fn time_of(&self, frame: &Frame, at: Instant) -> f64 {
        match self.exposed_since {
            Some(since) => self.time(since) + frame.stamp,
            None => self.time(at),
        }
    }
}
