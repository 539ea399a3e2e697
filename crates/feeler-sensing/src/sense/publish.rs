//! `feeler sense --publish`: publishes one finger's readings for the hand program.

use super::frames::WAIT;
use super::output::{FrameReadings, Output};
use super::queued::{BackgroundOutput, Backpressure};
use super::sensor::{self, SensorOf};
use super::source::Source;
use super::tally::SensingStats;
use super::{SenseOptions, close};
use feeler::sensor::forces::{ElementReading, SensingChain};
use feeler::sensor::image::{CameraError, Frame, Picture};
use feeler_console::{CommandError, is_raised};
use feeler_lab::config::{Experiment, Sensing};
use feeler_lab::experiment::rigs::linked::expected;
use feeler_link::inboxes::Exposed;
use feeler_link::programs::{SensorConfig, SensorProgram};
use feeler_link::security::Right;
use feeler_sources::{Captured, FramePump};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// The sensor program of one finger, with its optional output file and its statistics.
struct Publisher<'a> {
    program: SensorProgram,
    sensing: SensingChain,
    readings: Vec<ElementReading>,
    output: Option<Box<dyn Output>>,
    /// `true` once a warning was given that the images show another fingertip.
    is_mismatched: bool,
    tally: &'a mut SensingStats,
}

/// Processes and publishes the images of `source` until it ends or `stop` is raised.
pub fn publish(
    options: &SenseOptions,
    source: &Source,
    tally: &mut SensingStats,
    stop: &AtomicBool,
) -> Result<(), CommandError> {
    let settings = options.settings.clone();
    let experiment = Experiment::load(options.experiment(), &settings)?;
    let finger = options.finger.unwrap_or(0);
    experiment.fingertip(Some(finger))?;
    let mut publisher = Publisher::new(options, &experiment, finger, tally)?;
    let ended = match source {
        Source::Rig => publisher.sense_rig(&experiment, stop),
        source => publisher.sense_camera(options, source, stop),
    };
    let Publisher { output, tally, .. } = publisher;
    match output {
        Some(output) => close(output, tally, ended, source.is_stream() || !is_raised(stop)),
        None => {
            tally.close();
            ended
        }
    }
}

impl<'a> Publisher<'a> {
    fn new(
        options: &SenseOptions,
        experiment: &Experiment,
        finger: usize,
        tally: &'a mut SensingStats,
    ) -> Result<Self, CommandError> {
        let SensorOf { sensing, sha256 } = sensor::hand_sensor(options, experiment, finger)?;
        let elements = sensing.element_count();
        let config = SensorConfig {
            finger,
            elements,
            picture_size: sensing.picture_size(),
            thresholds: experiment.config.control.thresholds(),
            fingertip: sha256,
            expected: expected(experiment)?,
        };
        let output: Option<Box<dyn Output>> = match options.output {
            Some(_) => {
                let output = options.open_output(true)?;
                let queued = BackgroundOutput::start(
                    output,
                    Backpressure::DropAndIgnoreErrors,
                    options.record_frames,
                    tally.warner(),
                )?;
                Some(Box::new(queued))
            }
            None => None,
        };
        let rig = options.rig_name(experiment);
        let link = options.link.with_right(&[Right::Sense(finger)])?;
        let network = link.connect(&rig)?;
        let mut program = SensorProgram::new(&config, network)?;
        program.set_warn(tally.warner());
        Ok(Self {
            program,
            readings: vec![ElementReading::default(); elements],
            sensing,
            output,
            is_mismatched: false,
            tally,
        })
    }

    /// Processes the images of a rig that runs in another program.
    fn sense_rig(
        &mut self,
        experiment: &Experiment,
        stop: &AtomicBool,
    ) -> Result<(), CommandError> {
        let pictures = experiment.config.sensing == Sensing::Image;
        while !is_raised(stop) {
            let next = self.program.next_exposed(WAIT);
            self.program.check_peers();
            let Some(exposed) = next else { continue };
            let (at, taken) = (Instant::now(), exposed.header());
            match exposed {
                Exposed::Picture(message) if pictures => {
                    let picture = Picture {
                        width: message.width as usize,
                        height: message.height as usize,
                        pixels: message.pixels,
                    };
                    self.sensing.sense(&picture, &mut self.readings)?;
                    self.check_first(&picture);
                    let (header, sequence) = taken;
                    self.write_picture(&Frame {
                        sequence,
                        stamp: header.stamp,
                        picture,
                    })?;
                }
                Exposed::Forces(forces) if !pictures => {
                    for (reading, &force) in self.readings.iter_mut().zip(&forces.forces) {
                        reading.force = Some(force.into());
                    }
                }
                _ => continue,
            }
            let forces = self.readings.iter().map(|reading| reading.force);
            self.program.publish_exposed(taken, at, forces)?;
            let (header, number) = taken;
            self.write(header.sequence, number, header.stamp, at)?;
        }
        Ok(())
    }

    /// Processes the images of a camera or of files.
    fn sense_camera(
        &mut self,
        options: &SenseOptions,
        source: &Source,
        stop: &AtomicBool,
    ) -> Result<(), CommandError> {
        let size = self.sensing.picture_size();
        let pump = FramePump::start(source.camera(options, size)?, size)?;
        while !is_raised(stop) {
            self.program.check_peers();
            let Some(Captured { frame, at, report }) = pump.next(WAIT) else {
                continue;
            };
            if let Some(warning) = &report.warning {
                self.program.warn(warning);
            }
            match frame {
                Ok(frame) => {
                    self.sensing.sense(&frame.picture, &mut self.readings)?;
                    self.check_first(&frame.picture);
                    self.write_picture(&frame)?;
                    let forces = self.readings.iter().map(|reading| reading.force);
                    let taken = (frame.sequence, frame.stamp, at);
                    self.program.publish(taken, forces)?;
                    self.write(frame.sequence + 1, frame.sequence, frame.stamp, at)?;
                    pump.give_back(frame);
                }
                // While a rig is running, an unusable image is treated like a missing one.
                Err(error) if error.is_recoverable() => self.tally.skip(&error.to_string()),
                Err(CameraError::Ended { .. }) => return Ok(()),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// Warns once, on standard error and in the heartbeat, if the first images do not match the calibration's
    /// fingertip.
    ///
    /// Sensing continues, because the whole fingertip may be pressed when a sensor program starts.
    fn check_first(&mut self, picture: &Picture) {
        if self.is_mismatched {
            return;
        }
        if let Err(mismatch) = self.sensing.check_first(picture) {
            self.program.warn(&mismatch.to_string());
            self.is_mismatched = true;
        }
    }

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        match &mut self.output {
            Some(output) => output.write_picture(frame),
            None => Ok(()),
        }
    }

    /// Writes and counts the latest readings, from image `number`, the `sequence`-th one received, at time `at`.
    fn write(
        &mut self,
        sequence: u64,
        number: u64,
        stamp: f64,
        at: Instant,
    ) -> Result<(), CommandError> {
        if let Some(output) = &mut self.output {
            output.write(&FrameReadings {
                sequence: number,
                stamp,
                readings: &self.readings,
                markers: &[],
            })?;
        }
        self.tally.frame(sequence, at, &self.readings);
        Ok(())
    }
}
