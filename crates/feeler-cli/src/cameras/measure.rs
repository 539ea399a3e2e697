//! `feeler cameras --measure`: measures a camera's performance from a few seconds of images.

use super::measured::{Measured, Spread};
use super::{Arguments, CommandError, Kind, Outcome};
use feeler_console::{Working, is_raised, print_json, warn, watch_for_interrupt};
use feeler_sensing::{CameraName, CameraOptions, NAMES};
use feeler_sources::{Captured, FramePump};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Duration of a measurement, starting with the first image.
const DURATION: Duration = Duration::from_secs(5);
/// Maximum time until the first image.
const FIRST: Duration = Duration::from_secs(15);
/// Time to wait for an image before checking whether to stop.
const WAIT: Duration = Duration::from_millis(50);

/// Measures the camera `named`, or the only camera in `kinds` if none is named.
pub fn measure(
    arguments: &Arguments,
    named: Option<&Path>,
    kinds: impl FnOnce() -> [Kind; 2],
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let source = match named {
        Some(camera) => camera.to_path_buf(),
        None => only_camera(kinds())?,
    };
    let Some(name) = CameraName::parse(&source) else {
        let source = source.display();
        return Err(format!("--measure {source}: expected a camera, {NAMES}").into());
    };
    let interrupted = watch_for_interrupt()?;
    let (size, rate) = (arguments.size, arguments.rate);
    let camera = name
        .open(CameraOptions::from(&arguments.camera).settings(size, rate))?
        .camera;
    let pump = FramePump::start(camera, size)?;
    let working = Working::on("measuring");
    let mut counted = Counted::default();
    counted.count(&pump, &interrupted)?;
    drop(working);
    let measured = counted.measured(&source, size, rate)?;
    match arguments.json {
        true => print_json(&measured, out)?,
        false => measured.say(out)?,
    }
    Ok(match is_raised(&interrupted) {
        true => Outcome::GivenUp,
        false => Outcome::Done,
    })
}

/// Returns the only camera, to measure if none is named.
fn only_camera(kinds: [Kind; 2]) -> Result<PathBuf, CommandError> {
    let (mut names, mut missing) = (Vec::new(), Vec::new());
    for kind in kinds {
        names.extend(kind.cameras.into_iter().map(|camera| camera.name));
        missing.extend(kind.missing);
    }
    match &names[..] {
        [name] => Ok(PathBuf::from(name)),
        [] => {
            missing.insert(0, "--measure: no camera found".to_owned());
            Err(format!("{}; expected {NAMES}", missing.join("; ")).into())
        }
        _ => {
            let names = names.join(", ");
            Err(format!("--measure: several cameras found; expected one of {names}").into())
        }
    }
}

/// Counters of a measurement in progress.
#[derive(Default)]
struct Counted {
    frames: u64,
    damaged: u64,
    /// Frame number and stamp (s) of the first image.
    first: Option<(u64, f64)>,
    /// Frame number and stamp (s) of the latest image.
    newest: Option<(u64, f64)>,
    /// Intervals between images with consecutive frame numbers (s).
    intervals: Vec<f64>,
    /// Bytes of all images except the first, which was sent before the measurement began.
    bytes: Option<u64>,
    /// Decoding time of each image (s).
    decoding: Vec<f64>,
}

impl Counted {
    /// Counts images until the measurement ends or is `interrupted`.
    fn count(&mut self, pump: &FramePump, interrupted: &AtomicBool) -> Result<(), CommandError> {
        let began = Instant::now();
        let mut until = began + FIRST;
        while !is_raised(interrupted) && Instant::now() < until {
            let Some(captured) = pump.next(WAIT) else {
                continue;
            };
            let is_first = self.frames == 0;
            self.add(&captured);
            match captured.frame {
                Ok(frame) => {
                    if is_first {
                        until = Instant::now() + DURATION;
                    }
                    pump.give_back(frame);
                }
                Err(error) if error.is_recoverable() => warn(&error.to_string()),
                Err(error) => {
                    let frames = self.frames;
                    return Err(format!("{error} (after {frames} frames)").into());
                }
            }
        }
        Ok(())
    }

    fn add(&mut self, captured: &Captured) {
        if let Some(warning) = &captured.report.warning {
            warn(warning);
        }
        if matches!(&captured.frame, Err(error) if !error.is_recoverable()) {
            return;
        }
        let bytes = captured.report.bytes.map(|bytes| bytes as u64);
        if self.first.is_some() {
            self.bytes = (self.bytes.or(Some(0)).zip(bytes)).map(|(all, bytes)| all + bytes);
        } else {
            self.bytes = bytes.map(|_| 0);
        }
        let Ok(frame) = &captured.frame else {
            self.damaged += u64::from(self.first.is_some());
            return;
        };
        self.frames += 1;
        let taken = (frame.sequence, frame.stamp);
        if let Some((sequence, stamp)) = self.newest.replace(taken)
            && frame.sequence == sequence + 1
        {
            self.intervals.push(frame.stamp - stamp);
        }
        self.first.get_or_insert(taken);
        self.decoding.extend(
            captured
                .report
                .decoding
                .map(|duration| duration.as_secs_f64()),
        );
    }

    fn measured(
        &self,
        camera: &Path,
        (width, height): (usize, usize),
        requested_rate: f64,
    ) -> Result<Measured, CommandError> {
        let camera = camera.display().to_string();
        let (Some((first, began)), Some((newest, ended))) = (self.first, self.newest) else {
            return Err(format!("{camera}: no image received; expected at least 1").into());
        };
        let seconds = ended - began;
        // A single image has no rate.
        let per_second = |count: f64| (seconds > 0.0).then(|| count / seconds);
        let numbers = newest.saturating_sub(first);
        let later = self.frames - 1;
        Ok(Measured {
            camera,
            width_px: width,
            height_px: height,
            requested_rate,
            frames: self.frames,
            seconds,
            rate: per_second(later as f64),
            dropped: numbers.saturating_sub(later + self.damaged),
            damaged: self.damaged,
            bytes_per_second: self.bytes.and_then(|bytes| per_second(bytes as f64)),
            decoding: Spread::of(&self.decoding),
            interval: Spread::of(&self.intervals),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler::sensor::image::{Camera, CameraError, CaptureReport, Frame};

    /// Camera of 1000-byte images at 100 Hz: number 3 is damaged, 5 and 6 are dropped, 9 is the last.
    struct Lossy(u64);

    impl Camera for Lossy {
        fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
            let number = self.0;
            self.0 += if number == 4 { 3 } else { 1 };
            (frame.sequence, frame.stamp) = (number, 1.0 + 0.01 * number as f64);
            match number {
                3 => Err(CameraError::Unreadable {
                    name: "frame 3".into(),
                    reason: "torn".into(),
                }),
                10 => Err(CameraError::Failed("unplugged".into())),
                _ => Ok(()),
            }
        }

        fn take_report(&mut self) -> CaptureReport {
            CaptureReport {
                bytes: Some(1000),
                decoding: Some(Duration::from_millis(2)),
                warning: None,
            }
        }
    }

    #[test]
    fn rate_losses_and_bandwidth_are_measured() {
        let pump = FramePump::start(Lossy(0), (2, 1)).unwrap();
        let mut counted = Counted::default();
        let error = counted.count(&pump, &AtomicBool::new(false)).unwrap_err();
        assert!(
            error.to_string().contains("unplugged (after 7 frames)"),
            "{error}"
        );
        let measured = counted.measured(Path::new("cam"), (2, 1), 100.0).unwrap();
        assert_eq!(
            (measured.frames, measured.dropped, measured.damaged),
            (7, 2, 1)
        );
        assert!((measured.seconds - 0.09).abs() < 1e-9);
        assert!((measured.rate.unwrap() - 6.0 / 0.09).abs() < 1e-6);
        // All images after the first, including the damaged one.
        assert!((measured.bytes_per_second.unwrap() - 7000.0 / 0.09).abs() < 1e-6);
        let interval = measured.interval.as_ref().unwrap();
        assert!((interval.mean - 0.01).abs() < 1e-9 && interval.standard_deviation < 1e-9);
        assert_eq!(measured.decoding.as_ref().unwrap().max, 0.002);
        let mut words = Vec::new();
        measured.say(&mut words).unwrap();
        let words = String::from_utf8(words).unwrap();
        assert!(words.contains("2 dropped, 1 damaged"), "{words}");
    }

    #[test]
    fn a_measurement_requires_images() {
        let counted = Counted::default();
        let error = counted
            .measured(Path::new("cam"), (2, 1), 30.0)
            .unwrap_err();
        assert!(
            error.to_string().contains("cam: no image received"),
            "{error}"
        );
        assert_eq!(Spread::of(&[]), None);
    }
}
