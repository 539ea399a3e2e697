//! Reads the forces of a recorded run.

use super::contact::ContactFormat;
use super::output::{FrameReadings, Output};
use super::tally::SensingStats;
use super::{SenseOptions, close};
use feeler::sensor::forces::{ElementReading, SensorError, TactileFrame, TactileSensor};
use feeler_console::{CommandError, is_raised};
use feeler_record::{FingerModel, RecordedSensor, Recording};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Writes the forces of one finger of the recording at `path`.
pub fn sense(
    options: &SenseOptions,
    path: &Path,
    tally: &mut SensingStats,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let recording = Recording::read(path)?;
    let (finger, fingers) = (options.finger.unwrap_or(0), recording.fingers.len());
    if finger >= fingers {
        return Err(format!(
            "--finger {finger}: expected less than {fingers}, the number of fingers of the run"
        )
        .into());
    }
    let mut output = match options.contact {
        Some(contact) => {
            let model = recording.facts.hand.get(finger).into_iter();
            let elements = model.flat_map(FingerModel::elements);
            options.open_output_as(ContactFormat::new(contact, elements))?
        }
        None => options.open_output(true)?,
    };
    let mut sensor = RecordedSensor::new(&recording, finger);
    let ended = give_out(&mut sensor, output.as_mut(), tally, interrupted);
    let ended = ended.and_then(|()| match &recording.problem {
        None => Ok(()),
        Some(problem) => {
            let (path, until) = (path.display(), recording.readable_until);
            Err(format!(
                "{path}: the recording is incomplete ({problem}); forces are available up to {until:.2} s"
            )
            .into())
        }
    });
    close(output, tally, ended, !is_raised(interrupted))
}

fn give_out(
    sensor: &mut RecordedSensor,
    output: &mut dyn Output,
    tally: &mut SensingStats,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let elements = sensor.element_count();
    let mut frame = TactileFrame::unloaded(elements);
    let mut readings = vec![ElementReading::default(); elements];
    while !is_raised(interrupted) {
        match sensor.read(&mut frame) {
            Ok(()) => {}
            Err(SensorError::Ended { .. }) => break,
            Err(error) => return Err(error.into()),
        }
        let at = Instant::now();
        for (reading, &force) in readings.iter_mut().zip(&frame.forces) {
            // Without an image, only the force is known.
            *reading = ElementReading {
                integrated_gray: f64::NAN,
                force: Some(force),
                ..ElementReading::default()
            };
        }
        output.write(&FrameReadings {
            sequence: frame.sequence,
            stamp: frame.stamp,
            readings: &readings,
            markers: &[],
        })?;
        tally.frame(frame.sequence, at, &readings);
    }
    Ok(())
}
