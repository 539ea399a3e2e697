//! Pictures in, readings out.

use super::output::{FrameReadings, Output};
use super::sensor::sensor;
use super::source::Source;
use super::tally::Tally;
use super::{Arguments, CommandError, close, is_raised};
use feeler::sensor::camera::CameraError;
use feeler::sensor::frame::Frame;
use feeler::sensor::sensing::{ElementReading, Reference, SensingChain};
use feeler_sources::pump::FramePump;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// How long to wait for a frame before looking whether to stop.
const WAIT: Duration = Duration::from_millis(50);

/// Senses all frames of `source`, or those until `interrupted`.
pub fn sense(
    arguments: &Arguments,
    source: &Source,
    tally: &mut Tally,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let sensing = sensor(arguments)?;
    let size = sensing.picture_size();
    let camera = source.camera(arguments, size)?;
    let output = arguments.open_output(sensing.is_calibrated())?;
    let mut stage = Stage {
        readings: vec![ElementReading::default(); sensing.element_count()],
        sensing,
        unloaded: arguments.unloaded.unwrap_or(1) as usize,
        waiting: Vec::new(),
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
        match captured.frame {
            Ok(frame) => {
                stage.sense(&frame, captured.at)?;
                pump.give_back(frame);
            }
            Err(error @ CameraError::Unreadable { .. }) => stage.tally.skip(&error.to_string()),
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
    output: Box<dyn Output>,
    tally: &'a mut Tally,
}

impl Stage<'_> {
    /// Senses a frame that came in at `at`.
    fn sense(&mut self, frame: &Frame, at: Instant) -> Result<(), CommandError> {
        self.sensing.sense(&frame.picture, &mut self.readings)?;
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
            })?;
        }
        self.tally.frame(sequence, at, &self.readings);
        Ok(())
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
