//! `feeler calibrate FOLDER --live CAMERA --force-sensor ADDRESS`: guides a person through loading a fingertip.

mod folder;
mod guide;

use super::{Arguments, CommandError};
use crate::interrupt::watch_for_interrupt;
use crate::sense::source::{is_video_device, open_video};
use feeler::sensor::calibration::FullScale;
use feeler::sensor::camera::{Camera, CameraError};
use feeler::sensor::live_calibration::{ForceAxes, Goal, LiveCalibration, Seen};
use feeler::sensor::moments::ElementMoments;
use feeler_lab::sensor::SensorGeometry;
use feeler_sources::netft::{ForceSample, NetFt, NetFtAddress};
use feeler_sources::pump::{Captured, FramePump};
use feeler_sources::raw::RawFrames;
use folder::Folder;
use glam::DVec3;
use guide::Guide;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

pub use folder::LOADS;

/// How long to wait for a picture before looking at forces and Ctrl-C.
const WAIT: Duration = Duration::from_millis(20);

#[derive(Debug, clap::Args)]
pub struct LiveArguments {
    /// Guide through loading the fingertip, which stands on a force sensor, under this camera: /dev/videoN, or - for raw gray frames
    /// of the fingertip's size on standard input. LOADS.csv is then the folder that pictures and their LOADS.csv are
    /// kept in, and found again after Ctrl-C.
    #[arg(long, value_name = "CAMERA", requires_all = ["force_sensor", "input"], conflicts_with_all = ["simulated", "wrench"])]
    pub live: Option<PathBuf>,
    /// The force sensor under the fingertip: netft://HOST?cpf=COUNTS&cpt=COUNTS (ATI Net F/T, RDT over UDP), with the counts per
    /// newton and newton metre that its web page shows.
    #[arg(long, value_name = "ADDRESS", requires = "live")]
    force_sensor: Option<NetFtAddress>,
    /// The force sensor's axes that are x, y and z of the fingertip, as in z,x,y: of a fingertip of known dome x is its axis,
    /// outward; of a layout without one, x is to the right in the picture, y down and z away from the camera.
    #[arg(long, value_name = "AXES", default_value = "x,y,z", requires = "live")]
    force_axes: ForceAxes,
    /// Frames per second that the camera is asked for.
    #[arg(long, value_name = "HZ", default_value_t = 30.0, requires = "live", value_parser = crate::sense::parse_rate)]
    rate: f64,
    /// Exposure time of the camera, s [default: as the camera is set]
    #[arg(long, value_name = "SECONDS", requires = "live", value_parser = crate::sense::parse_exposure)]
    exposure: Option<f64>,
}

impl LiveArguments {
    fn camera(
        &self,
        camera: &Path,
        size: (usize, usize),
    ) -> Result<Box<dyn Camera + Send>, CommandError> {
        if camera == Path::new("-") {
            return Ok(Box::new(RawFrames::new(std::io::stdin(), size, self.rate)));
        }
        if !is_video_device(camera) {
            let camera = camera.display();
            return Err(format!("--live {camera}: expected a camera, /dev/videoN, or -").into());
        }
        open_video(camera, size, self.rate, self.exposure)
    }
}

/// The folder of pictures and loads, which is made if there is none.
pub fn folder(arguments: &Arguments) -> Option<&Path> {
    let input = arguments.input.as_deref()?;
    arguments.live.live.as_ref().map(|_| Path::new(input))
}

/// What a person should reach: full scale, as far as the command line says; by default 1 N, and half of it of shear.
fn goal(arguments: &Arguments) -> Goal {
    let normal = arguments.full_scale_normal.unwrap_or(1.0);
    let shear = arguments.full_scale_shear.unwrap_or(0.5 * normal);
    Goal { normal, shear }
}

/// Guides through the loads until the folder has all that is needed, or Ctrl-C.
///
/// # Errors
/// When the camera ends, or the folder cannot be written to; what was kept is there all the same, as after Ctrl-C.
pub fn guide(
    arguments: &Arguments,
    folder: &Path,
    sensor: &SensorGeometry,
) -> Result<(), CommandError> {
    let live = &arguments.live;
    let address = live
        .force_sensor
        .as_ref()
        .ok_or("--live: expected --force-sensor, too")?;
    let camera = live.live.as_deref().unwrap_or(Path::new("-"));
    let goal = goal(arguments);
    let mut kept = Folder::open(folder, sensor, &goal)?;
    let forces = NetFt::connect(address)?;
    let pump = FramePump::start(live.camera(camera, sensor.size)?, sensor.size)?;
    let interrupted = watch_for_interrupt()?;
    let calibration = LiveCalibration::new(sensor.frames.clone(), goal, kept.coverage());
    let full_scale = FullScale {
        normal: goal.normal,
        shear: goal.shear,
    };
    let mut guided = Guided {
        sensor,
        axes: live.force_axes,
        began: Instant::now(),
        moments: vec![ElementMoments::default(); sensor.kernel.element_count()],
        calibration,
        guide: Guide::new(sensor, full_scale, arguments.model),
    };
    let ended = guided.run(&forces, &pump, &mut kept, &interrupted);
    let left = guided.left();
    guided.guide.end();
    match (ended, left) {
        (Ok(()), 0) => Ok(()),
        (ended, left) => {
            let (place, all) = (folder.display(), sensor.kernel.element_count());
            let why = ended
                .err()
                .map_or_else(|| "interrupted".to_string(), |e| e.to_string());
            let loads = folder.join(LOADS);
            Err(format!(
                "{why}: {} pictures are kept in {place}, and {left} of {all} elements need more; the same command goes on from there, and \
                 `feeler calibrate {}` calibrates by what there is",
                kept.pictures(),
                loads.display()
            )
            .into())
        }
    }
}

/// A person at work.
struct Guided<'a> {
    sensor: &'a SensorGeometry,
    axes: ForceAxes,
    began: Instant,
    moments: Vec<ElementMoments>,
    calibration: LiveCalibration,
    guide: Guide<'a>,
}

impl Guided<'_> {
    /// Elements of which something is missing.
    fn left(&self) -> usize {
        let elements = self.calibration.coverage().iter();
        elements.filter(|element| !element.is_complete()).count()
    }

    fn run(
        &mut self,
        forces: &NetFt,
        pump: &FramePump,
        kept: &mut Folder,
        interrupted: &AtomicBool,
    ) -> Result<(), CommandError> {
        while self.left() > 0 && !interrupted.load(Ordering::Relaxed) {
            let captured = pump.next(WAIT);
            loop {
                match forces.next_sample() {
                    Ok(Some(sample)) => self.force(&sample),
                    Ok(None) => break,
                    Err(error) => self.guide.warn(&error.to_string()),
                }
            }
            if let Some(Captured { frame, at }) = captured {
                match frame {
                    Ok(frame) => {
                        self.picture(&frame.picture, at, kept)?;
                        pump.give_back(frame);
                    }
                    Err(error) if error.may_pass() => self.guide.warn(&error.to_string()),
                    Err(CameraError::Ended { .. }) => return Err("the camera has ended".into()),
                    Err(error) => return Err(error.into()),
                }
            }
            self.guide.show(&self.calibration);
        }
        Ok(())
    }

    /// Seconds on the clock of arrivals.
    fn time(&self, at: Instant) -> f64 {
        at.saturating_duration_since(self.began).as_secs_f64()
    }

    fn force(&mut self, sample: &ForceSample) {
        let [x, y, z, ..] = sample.wrench;
        let force = self.axes.to_fingertip(DVec3::new(x, y, z));
        self.calibration.force(self.time(sample.at), force);
    }

    fn picture(
        &mut self,
        picture: &feeler::sensor::frame::Picture,
        at: Instant,
        kept: &mut Folder,
    ) -> Result<(), CommandError> {
        self.sensor.kernel.measure(picture, &mut self.moments)?;
        let seen = self.calibration.picture(self.time(at), &self.moments);
        match seen {
            Seen::Untouched => kept.untouched(picture)?,
            Seen::Sample { element, force } => {
                kept.sample(picture, element, force)?;
                self.guide.sample(element, force, &self.moments);
            }
            Seen::Nothing | Seen::Unclear | Seen::Enough { .. } => {}
        }
        self.guide.seen(&seen);
        Ok(())
    }
}
