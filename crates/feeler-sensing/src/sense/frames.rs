//! Pictures in, readings out.

use super::assumed::AssumedFingertip;
use super::output::{FrameReadings, Output};
use super::sensor::{asked_sensor, sensing_of};
use super::source::Source;
use super::tally::Tally;
use super::wrench::OfWrench;
use super::{SenseOptions, close};
use feeler::sensor::camera::CameraError;
use feeler::sensor::frame::Frame;
use feeler::sensor::sensing::{ElementReading, Reference, SensingChain};
use feeler_console::{CommandError, is_raised};
use feeler_sources::pump::FramePump;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// How long to wait for a frame before looking whether to stop.
pub const WAIT: Duration = Duration::from_millis(50);

/// Senses all frames of `source`, or those until `interrupted`.
pub fn sense(
    options: &SenseOptions,
    source: &Source,
    tally: &mut Tally,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let geometry = asked_sensor(options)?;
    let assumed = AssumedFingertip::of(options, &geometry)?;
    let (sensing, estimator) = sensing_of(geometry, options)?;
    let size = sensing.picture_size();
    let camera = source.camera(options, size)?;
    let pictures = options.recorded_finger();
    let output = match estimator {
        Some(estimator) => options.open_output_as(&OfWrench {
            estimator,
            pictures,
        })?,
        None => options.open_output(sensing.is_calibrated())?,
    };
    let output = options.beside_the_sensor(output, source, tally)?;
    let mut stage = Stage {
        readings: vec![ElementReading::default(); sensing.element_count()],
        sensing,
        unloaded: options.unloaded.unwrap_or(1) as usize,
        waiting: Vec::new(),
        assumed,
        output,
        tally,
    };
    let pump = FramePump::start(camera, size)?;
    let ended = sense_all(&pump, &mut stage, interrupted);
    let settled = stage.settle_reference();
    let whole = source.is_stream() || !is_raised(interrupted);
    close(stage.output, stage.tally, ended.and(settled), whole)
}

fn sense_all(
    pump: &FramePump,
    stage: &mut Stage,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    while !is_raised(interrupted) {
        // What is written is handed on as soon as no frame waits.
        let mut captured = pump.next(Duration::ZERO);
        if captured.is_none() {
            stage.output.flush()?;
            captured = pump.next(WAIT);
        }
        let Some(captured) = captured else { continue };
        if let Some(warning) = &captured.report.warning {
            stage.tally.warn(warning);
        }
        match captured.frame {
            Ok(frame) => {
                stage.sense(&frame, captured.at)?;
                pump.give_back(frame);
            }
            Err(error) if error.may_pass() => {
                stage.check_size(&error)?;
                stage.tally.skip(&error.to_string());
            }
            Err(CameraError::Ended { .. }) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

/// From a frame to what is written.
struct Stage<'a> {
    sensing: SensingChain,
    readings: Vec<ElementReading>,
    /// Frames whose mean becomes the reference, where there is none.
    unloaded: usize,
    /// Such frames: number, stamp (s), readings.
    waiting: Vec<(u64, f64, Vec<ElementReading>)>,
    /// The fingertip that the first picture must be of, where nobody has named one.
    assumed: Option<AssumedFingertip>,
    output: Box<dyn Output>,
    tally: &'a mut Tally,
}

impl Stage<'_> {
    /// Senses a frame that came in at `at`.
    fn sense(&mut self, frame: &Frame, at: Instant) -> Result<(), CommandError> {
        let failed = |e: &dyn std::fmt::Display| format!("frame {}: {e}", frame.sequence);
        let sensed = self.sensing.sense(&frame.picture, &mut self.readings);
        sensed.map_err(|e| failed(&e))?;
        if let Some(assumed) = self.assumed.take() {
            let note = assumed.check(&frame.picture, self.sensing.moments());
            self.tally.note(&note.map_err(|e| failed(&e))?);
        }
        self.output.write_picture(frame)?;
        let (sequence, stamp) = (frame.sequence, frame.stamp);
        if self.sensing.reference().is_none() {
            let readings = self.readings.clone();
            self.waiting.push((sequence, stamp, readings));
            if self.waiting.len() >= self.unloaded {
                self.settle_reference()?;
            }
        } else {
            self.output.write(&FrameReadings {
                sequence,
                stamp,
                readings: &self.readings,
                markers: &[],
            })?;
        }
        self.tally.picture(sequence, at, &self.readings);
        Ok(())
    }

    /// Refuses a first picture of another size than those of the fingertip that is assumed.
    fn check_size(&self, error: &CameraError) -> Result<(), CommandError> {
        match (&self.assumed, error) {
            (
                Some(assumed),
                CameraError::PictureSize {
                    name,
                    width,
                    height,
                    ..
                },
            ) => Err(assumed.refuse_size(name, (*width, *height)).into()),
            _ => Ok(()),
        }
    }

    /// Makes the reference of the frames that wait for it, and writes them.
    fn settle_reference(&mut self) -> Result<(), CommandError> {
        let waiting = std::mem::take(&mut self.waiting);
        if waiting.is_empty() {
            return Ok(());
        }
        let (count, wanted) = (waiting.len(), self.unloaded);
        if count < wanted {
            let warning = format!("u counts from {count} frames without load, {wanted} expected");
            self.tally.warn(&warning);
        }
        let reference = Reference::mean(waiting.iter().map(|(_, _, r)| r.as_slice()));
        for (sequence, stamp, mut readings) in waiting {
            reference.apply(&mut readings);
            self.output.write(&FrameReadings {
                sequence,
                stamp,
                readings: &readings,
                markers: &[],
            })?;
        }
        let unknown = reference.centroids.iter().filter(|c| c.is_none()).count();
        if unknown > 0 {
            let warning = format!("{unknown} elements are dark without load; u is left out there");
            self.tally.warn(&warning);
        }
        Ok(self.sensing.set_reference(reference)?)
    }
}
