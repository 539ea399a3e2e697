//! Sensors selected by the command-line options.

use super::SenseOptions;
use crate::calibration::require_verified;
use feeler::sensor::calibration::Calibration;
use feeler::sensor::forces::{DriftConfig, ElementReading, Reference, SensingChain};
use feeler::sensor::wrench::WrenchEstimator;
use feeler_console::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::sensor::SensorGeometry;
use feeler_sources::read_picture;
use std::fmt::Display;
use std::path::Path;

/// Returns the located layout if `--layout` is given, otherwise the experiment's fingertip.
pub fn sensor_geometry(options: &SenseOptions) -> Result<SensorGeometry, CommandError> {
    let layout = options.layout.as_deref();
    named_sensor(options.experiment(), options.finger, layout)
}

/// Creates the sensing chain of a sensor with its calibration or reference, if any, and the wrench estimator if the
/// calibration is a wrench calibration.
pub fn sensing_chain(
    mut geometry: SensorGeometry,
    options: &SenseOptions,
) -> Result<(SensingChain, Option<WrenchEstimator>), CommandError> {
    let calibration = options.calibration.as_deref();
    let estimator = calibration.map(|path| named_estimator(&mut geometry, path));
    let estimator = estimator.transpose()?.flatten();
    check_verified(options, estimator.as_ref())?;
    let calibration = calibration.filter(|_| estimator.is_none());
    let calibration = calibration.map(|path| named_calibration(&mut geometry, path));
    let calibration = calibration.transpose()?;
    geometry.max_saturated = options.max_saturated.unwrap_or(geometry.max_saturated);
    let mut sensing = geometry.sensing_chain()?;
    if let Some(calibration) = calibration {
        sensing = sensing.with_calibration(calibration)?;
    }
    if let Some(estimator) = &estimator {
        if options.drift_correction {
            let message = "--drift-correction: has no effect with a wrench calibration, which a common gain does not \
                           change; use a calibration of elements";
            return Err(message.into());
        }
        sensing.set_reference(estimator.reference())?;
    }
    if options.drift_correction {
        sensing = sensing.with_drift_correction(DriftConfig::default());
    }
    if let Some(path) = &options.reference {
        let failed = |e: CommandError| format!("--reference {}: {e}", path.display());
        let reference = reference(path, &mut sensing).map_err(failed)?;
        sensing.set_reference(reference)?;
    }
    Ok((sensing, estimator))
}

/// The sensor of one finger for the hand program.
pub struct SensorOf {
    /// Sensing chain from images to forces.
    pub sensing: SensingChain,
    /// SHA-256 of the fingertip or layout, used by the hand as its identifier.
    pub sha256: String,
}

/// Creates the sensor of `finger` of `experiment` with the layout and calibration in `options`, or by default those of
/// the experiment.
pub fn hand_sensor(
    options: &SenseOptions,
    experiment: &Experiment,
    finger: usize,
) -> Result<SensorOf, CommandError> {
    check_verified(options, None)?;
    let mut geometry = match &options.layout {
        layout @ Some(_) => named_sensor(options.experiment(), None, layout.as_deref())?,
        None => SensorGeometry::of_fingertip(experiment.fingertip(Some(finger))?)?,
    };
    let calibration = match &options.calibration {
        Some(path) => named_calibration(&mut geometry, path)?,
        None => {
            let calibration = experiment.calibration(finger)?;
            geometry.made_for.verify_same(&calibration.made_for)?;
            calibration
        }
    };
    geometry.max_saturated = options.max_saturated.unwrap_or(geometry.max_saturated);
    let sensing = geometry.sensing_chain()?.with_calibration(calibration)?;
    let asked = options.drift_correction.then(DriftConfig::default);
    let sensing = match experiment.config.sensor.drift.or(asked) {
        Some(drift) => sensing.with_drift_correction(drift),
        None => sensing,
    };
    Ok(SensorOf {
        sensing,
        sha256: geometry.made_for.sha256,
    })
}

/// Checks that the calibration was verified within the time that `options` require.
fn check_verified(
    options: &SenseOptions,
    estimator: Option<&WrenchEstimator>,
) -> Result<(), CommandError> {
    match (options.verified_within, estimator) {
        (None, _) => Ok(()),
        (Some(days), Some(estimator)) => require_verified(estimator.calibration(), days)
            .map_err(|e| format!("--verified-within {days}: {e}").into()),
        (Some(days), None) => Err(format!(
            "--verified-within {days}: expected a wrench calibration; calibrations of elements are not verified"
        )
        .into()),
    }
}

/// Returns the located sensor of `layout`, if given, otherwise the fingertip of `finger` of the experiment `name`.
pub fn named_sensor(
    name: &str,
    finger: Option<usize>,
    layout: Option<&Path>,
) -> Result<SensorGeometry, CommandError> {
    match layout {
        Some(path) => SensorGeometry::read_layout(path)
            .map_err(|e| format!("--layout {}: {e}", path.display()).into()),
        None => Ok(SensorGeometry::of_experiment(name, finger)?),
    }
}

/// Reads the calibration at `path` (`--calibration`) and checks that it belongs to the sensor.
fn named_calibration(
    geometry: &mut SensorGeometry,
    path: &Path,
) -> Result<Calibration, CommandError> {
    if named_estimator(geometry, path)?.is_some() {
        let path = path.display();
        return Err(format!(
            "--calibration {path}: expected a calibration of elements, got a wrench calibration"
        )
        .into());
    }
    let read = geometry.read_calibration(path);
    read.map_err(|e| format!("--calibration {}: {e}", path.display()).into())
}

/// Creates the wrench estimator of the calibration at `path`, or returns `None` if it calibrates single elements. Also
/// configures marker tracking.
fn named_estimator(
    geometry: &mut SensorGeometry,
    path: &Path,
) -> Result<Option<WrenchEstimator>, CommandError> {
    let named = |e: &dyn Display| format!("--calibration {}: {e}", path.display());
    let read = geometry.read_wrench_calibration(path);
    let calibration = read.map_err(|e| named(&e))?;
    let estimator = calibration.map(WrenchEstimator::new).transpose();
    Ok(estimator.map_err(|e| named(&e))?)
}

/// Measures the unloaded centroids in the image at `path`.
fn reference(path: &Path, sensing: &mut SensingChain) -> Result<Reference, CommandError> {
    let picture = read_picture(path)?;
    let mut readings = vec![ElementReading::default(); sensing.element_count()];
    sensing.sense(&picture, &mut readings)?;
    Ok(Reference::from_readings([readings.as_slice()]))
}
