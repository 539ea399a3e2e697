//! The sensor that the arguments describe.

use super::{Arguments, CommandError};
use crate::cli::sensor_geometry::SensorGeometry;
use crate::sensor::drift::DriftConfig;
use crate::sensor::sensing::{ElementReading, Reference, Sensing};
use crate::sources::picture::read_picture;
use std::path::Path;

/// The sensing of the experiment's fingertip or of the located layout, with calibration or reference
/// if there is one.
pub fn sensor(arguments: &Arguments) -> Result<Sensing, CommandError> {
    let layout = arguments.layout.as_deref();
    let geometry = SensorGeometry::of(&arguments.experiment, arguments.finger, layout)?;
    let calibration = arguments.calibration.as_deref();
    let calibration = calibration.map(|path| geometry.read_calibration(path));
    let calibration = calibration.transpose()?;
    let SensorGeometry {
        size,
        kernel,
        regions,
        ..
    } = geometry;
    let mut sensing = Sensing::new(size, kernel, &regions, arguments.max_saturated)?;
    if let Some(calibration) = calibration {
        sensing = sensing.with_calibration(calibration)?;
    }
    if arguments.drift_correction {
        sensing = sensing.with_drift_correction(DriftConfig::default());
    }
    if let Some(path) = &arguments.reference {
        let failed = |e: CommandError| format!("--reference {}: {e}", path.display());
        let reference = reference(path, &mut sensing).map_err(failed)?;
        sensing.set_reference(reference)?;
    }
    Ok(sensing)
}

/// Where the centroids are in the picture at `path`.
fn reference(path: &Path, sensing: &mut Sensing) -> Result<Reference, CommandError> {
    let picture = read_picture(path)?;
    let mut readings = vec![ElementReading::default(); sensing.element_count()];
    sensing.sense(&picture, &mut readings)?;
    Ok(Reference::mean([readings.as_slice()]))
}
