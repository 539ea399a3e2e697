//! Guided calibration and verification: a person presses the fingertip on a force sensor under a camera.

mod elements;
mod folder;
mod force;
mod guide;
mod presses;
mod screen;
mod whole;

use crate::camera::{CameraName, CameraOptions, NAMES, OpenCamera};
use elements::Elements;
use feeler::sensor::calibration::{ForceAxes, Goal, ModelChoice, Wrench};
use feeler::sensor::image::{CameraError, Frame, Picture};
use feeler::sensor::moments::ElementMoments;
use feeler_console::{CommandError, watch_for_interrupt};
use feeler_lab::sensor::SensorGeometry;
use feeler_sources::{Captured, ForceSample, FramePump, RawFrames};
use folder::Folder;
pub use force::ForceAddress;
use force::ForceSensor;
use glam::DVec3;
use presses::Presses;
use screen::Screen;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use whole::Whole;

/// Name of the table of loads on single elements.
pub const LOADS: &str = "LOADS.csv";
/// Name of the table of wrenches on the whole fingertip.
pub const FORCES: &str = "FORCES.csv";

/// Maximum number of images that wait for their forces: half a second of a fast camera.
const WAITING: usize = 32;
/// Time to wait for an image before checking for forces and Ctrl-C.
const WAIT: Duration = Duration::from_millis(20);

/// Task of the operator.
#[derive(Debug, Clone, Copy)]
pub enum Procedure {
    /// Load single elements up to the goal, to fit the model.
    Elements(Goal, ModelChoice),
    /// Load the whole fingertip up to the goal.
    Whole(Goal),
    /// Press the whole fingertip this number of times with about this force (N).
    Presses(f64, u32),
}

/// Camera and force sensor of a guided calibration or verification.
#[derive(Debug, Clone)]
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

/// A guided procedure: the loads that it requires, and the images that it saves.
trait Work {
    /// Adds a load on the fingertip, in its frame, measured at `at` (s).
    fn load(&mut self, at: f64, load: Wrench);
    /// Returns `true` if all loads needed for an image taken at `at` (s) have arrived.
    fn is_ready(&self, at: f64) -> bool;
    /// Processes an image taken at `at` (s), and its moments. Shows warnings on `screen`.
    fn picture(
        &mut self,
        at: f64,
        picture: &Picture,
        moments: &[ElementMoments],
        screen: &mut Screen,
    ) -> Result<(), CommandError>;
    /// Shows the progress.
    fn show(&mut self, screen: &mut Screen);
    /// Returns the folder of saved images.
    fn kept(&self) -> &Folder;
    /// Describes the missing loads, or returns `None` if the procedure is complete.
    fn missing(&self) -> Option<String>;
}

/// Guides the operator through `procedure` until the folder contains all required loads, or until Ctrl-C.
///
/// # Errors
/// If the camera stream ends, the folder is not writable, or the procedure is interrupted. Images saved so far are
/// kept.
pub fn guide(
    options: &GuideOptions<'_>,
    procedure: Procedure,
    folder: &Path,
    sensor: &SensorGeometry,
) -> Result<(), CommandError> {
    let work: Box<dyn Work + '_> = match procedure {
        Procedure::Whole(goal) => Box::new(Whole::open(folder, sensor, goal)?),
        Procedure::Elements(goal, model) => Box::new(Elements::open(folder, sensor, goal, model)?),
        Procedure::Presses(force, wanted) => Box::new(Presses::open(folder, force, wanted)?),
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
        screen: Screen::new(),
    };
    let ended = guided.run(&forces, &pump, &interrupted);
    guided.screen.end();
    let missing = guided.work.missing();
    if ended.is_ok() && missing.is_none() {
        return Ok(());
    }
    let why = ended
        .err()
        .map_or_else(|| "interrupted".to_string(), |e| e.to_string());
    let missing = missing.unwrap_or_else(|| "nothing is missing".into());
    let (kept, place) = (guided.work.kept(), folder.display());
    let (count, table) = (kept.pictures(), kept.table().display());
    let next = match procedure {
        Procedure::Elements(..) => format!(
            "Repeat the command to continue, or run `feeler calibrate {table}` to calibrate with these images"
        ),
        Procedure::Whole(_) => format!(
            "Repeat the command to continue, or run `feeler calibrate {table} --wrench` to calibrate with these images"
        ),
        Procedure::Presses(..) => "Repeat the command with a new folder".to_string(),
    };
    Err(format!("{why}: saved {count} images in {place}; {missing}. {next}").into())
}

/// State of a guided calibration.
struct Guided<'a> {
    sensor: &'a SensorGeometry,
    axes: ForceAxes,
    began: Instant,
    /// Time at which the camera's stamps were 0, if they are times of exposure.
    exposed_since: Option<Instant>,
    /// Time (s) and frame of each image whose forces have not arrived yet.
    waiting: VecDeque<(f64, Frame)>,
    moments: Vec<ElementMoments>,
    work: Box<dyn Work + 'a>,
    screen: Screen,
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
                    Err(error) => self.screen.warn(&error.to_string()),
                }
            }
            if let Some(Captured { frame, at, report }) = captured {
                if let Some(warning) = &report.warning {
                    self.screen.warn(warning);
                }
                match frame {
                    Ok(frame) => self.waiting.push_back((self.time_of(&frame, at), frame)),
                    Err(error) if error.is_recoverable() => self.screen.warn(&error.to_string()),
                    Err(CameraError::Ended { .. }) => {
                        return Err("the camera stream has ended".into());
                    }
                    Err(error) => return Err(error.into()),
                }
            }
            self.pictures(pump)?;
            self.work.show(&mut self.screen);
        }
        Ok(())
    }

    /// Processes the images whose forces are known, and the oldest ones if too many wait.
    fn pictures(&mut self, pump: &FramePump) -> Result<(), CommandError> {
        while let Some(&(at, _)) = self.waiting.front()
            && (self.work.is_ready(at) || self.waiting.len() > WAITING)
            && let Some((at, frame)) = self.waiting.pop_front()
        {
            let picture = &frame.picture;
            self.sensor.kernel.measure(picture, &mut self.moments)?;
            self.work
                .picture(at, picture, &self.moments, &mut self.screen)?;
            pump.give_back(frame);
        }
        Ok(())
    }

    /// Converts an instant to the common clock of forces and images (s).
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

    /// Returns the time (s) of an image: of its exposure if the camera reports it, otherwise of its arrival.
    fn time_of(&self, frame: &Frame, at: Instant) -> f64 {
        match self.exposed_since {
            Some(since) => self.time(since) + frame.stamp,
            None => self.time(at),
        }
    }
}
