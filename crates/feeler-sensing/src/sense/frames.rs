//! Converts images to readings and writes them.

use super::assumed::AssumedFingertip;
use super::contact::ContactFormat;
use super::output::{FrameReadings, Output};
use super::sensor::{sensing_chain, sensor_geometry};
use super::source::Source;
use super::tally::SensingStats;
use super::wrench::{Estimates, WrenchFormat};
use super::{SenseOptions, close};
use feeler::sensor::forces::{ElementReading, Reference, SensingChain};
use feeler::sensor::image::{CameraError, Frame};
use feeler_console::{CommandError, is_raised};
use feeler_sources::FramePump;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Maximum time to wait for a frame before the interrupt flag is checked.
pub const WAIT: Duration = Duration::from_millis(50);

/// Converts the frames of `source` to readings until it ends or `interrupted` is set.
pub fn sense(
    options: &SenseOptions,
    source: &Source,
    tally: &mut SensingStats,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let geometry = sensor_geometry(options)?;
    let assumed = AssumedFingertip::of(options, &geometry)?;
    let places = geometry.places();
    let (sensing, estimator) = sensing_chain(geometry, options)?;
    let size = sensing.picture_size();
    let camera = source.camera(options, size)?;
    let pictures = options.recorded_finger();
    let output = match (options.contact, estimator) {
        (Some(contact), None) if sensing.is_calibrated() => {
            let places = places.ok_or("--contact: requires the dome's geometry in the layout")?;
            options.open_output_as(ContactFormat::new(contact, places))?
        }
        (Some(_), _) => {
            return Err("--contact: requires --calibration with a calibration of elements".into());
        }
        (None, Some(estimator)) => options.open_output_as(WrenchFormat {
            estimates: Estimates::new(estimator),
            pictures,
        })?,
        (None, None) => options.open_output(sensing.is_calibrated())?,
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
        // Flush as soon as no frame is waiting.
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
            Err(error) if error.is_recoverable() => {
                stage.check_size(&error)?;
                stage.tally.skip(&error.to_string());
            }
            Err(CameraError::Ended { .. }) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

/// Converts frames to readings and writes them.
struct Stage<'a> {
    sensing: SensingChain,
    readings: Vec<ElementReading>,
    /// Number of frames whose mean becomes the reference if none is given.
    unloaded: usize,
    /// Number, stamp (s) and readings of each frame that waits for the reference.
    waiting: Vec<(u64, f64, Vec<ElementReading>)>,
    /// Fingertip that the first image must show if no fingertip was named.
    assumed: Option<AssumedFingertip>,
    output: Box<dyn Output>,
    tally: &'a mut SensingStats,
}

impl Stage<'_> {
    /// Converts a frame received at `at` to readings.
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

    /// Returns an error if `error` is that of a first image whose size differs from the assumed fingertip's.
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

    /// Computes the reference from the waiting frames and writes them.
    fn settle_reference(&mut self) -> Result<(), CommandError> {
        let waiting = std::mem::take(&mut self.waiting);
        if waiting.is_empty() {
            return Ok(());
        }
        let (count, wanted) = (waiting.len(), self.unloaded);
        if count < wanted {
            let warning = format!("u is measured from {count} unloaded frames; expected {wanted}");
            self.tally.warn(&warning);
        }
        let reference = Reference::from_readings(waiting.iter().map(|(_, _, r)| r.as_slice()));
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
            let warning =
                format!("{unknown} elements are dark in the unloaded frames; their u is omitted");
            self.tally.warn(&warning);
        }
        Ok(self.sensing.set_reference(reference)?)
    }
}
