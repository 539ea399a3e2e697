//! The sensor that the arguments describe.

use super::{Arguments, CommandError};
use crate::config::Experiment;
use crate::sensor::calibration::Calibration;
use crate::sensor::sensing::{ElementReading, Reference, Sensing};
use crate::sources::picture::read_picture;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest calibration file, bytes.
const MAX_TEXT: u64 = 16 << 20;

/// The sensing of the experiment's fingertip, with calibration or reference if there is one.
pub fn sensor(arguments: &Arguments) -> Result<Sensing, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &[])?;
    let fingertip = &experiment.config.sensor.fingertip;
    let mut sensing = Sensing::of_fingertip_saturated(fingertip, arguments.max_saturated)?;
    if let Some(path) = &arguments.calibration {
        let calibration = read_calibration(path)?;
        let fits = calibration.check_made_for(fingertip);
        let fitted = fits.map(|()| calibration);
        let fitted = fitted.map_err(|e| format!("--calibration {}: {e}", path.display()))?;
        sensing = sensing.with_calibration(fitted)?;
    }
    if let Some(path) = &arguments.reference {
        let failed = |e: CommandError| format!("--reference {}: {e}", path.display());
        let reference = reference(path, &mut sensing).map_err(failed)?;
        sensing.set_reference(reference)?;
    }
    Ok(sensing)
}

fn read_calibration(path: &Path) -> Result<Calibration, CommandError> {
    let read = || -> Result<Calibration, CommandError> {
        let mut text = String::new();
        let mut file = File::open(path)?.take(MAX_TEXT);
        file.read_to_string(&mut text)?;
        Ok(Calibration::from_toml(&text)?)
    };
    read().map_err(|e| format!("--calibration {}: {e}", path.display()).into())
}

/// Where the centroids are in the picture at `path`.
fn reference(path: &Path, sensing: &mut Sensing) -> Result<Reference, CommandError> {
    let picture = read_picture(path)?;
    let mut readings = vec![ElementReading::default(); sensing.element_count()];
    sensing.sense(&picture, &mut readings)?;
    Ok(Reference::mean([readings.as_slice()]))
}
