//! Calibration of a simulated fingertip as in a laboratory: known loads, images, least squares.

use super::config::CalibrationBenchConfig;
use super::loads::{Load, in_patches, program};
use crate::optics::config::OpticsConfig;
use crate::optics::error::OpticsError;
use crate::optics::model::OpticsModel;
use crate::optics::renderer::{OpticsScratch, render};
use feeler::sensor::calibration::{
    Calibration, CalibrationError, CalibrationTarget, ElementRecord, LoadSample, fit,
};
use feeler::sensor::fingertip::{Fingertip, FingertipConfig, FingertipError};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::{ElementMoments, MomentsError};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Error when calibrating a simulated fingertip.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationBenchError {
    /// The fingertip is invalid.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// The optics are invalid.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// Moments could not be measured.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The loads do not determine a calibration.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// A length is negative or not finite.
    #[error("{name} must be at least 0, got {value}")]
    Negative {
        /// Name of the field.
        name: &'static str,
        /// Value of the field.
        value: f64,
    },
    /// A parameter of the loads is not positive or not finite.
    #[error("{name} must be positive, got {value}")]
    NotPositive {
        /// Name of the field.
        name: &'static str,
        /// Value of the field.
        value: f64,
    },
}

/// Calibrates `fingertip` with simulated `optics`.
///
/// # Errors
/// If a configuration is invalid, or its loads do not determine a calibration.
pub fn calibrate_simulated(
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
) -> Result<Calibration, CalibrationBenchError> {
    let records = load_simulated(fingertip, optics, bench)?;
    let made_for = CalibrationTarget::fingertip(fingertip)?;
    Ok(fit(made_for, &records, bench.model, bench.full_scale)?)
}

/// Loads `fingertip` in simulation and measures the moments of its elements.
///
/// # Errors
/// If a configuration is invalid.
pub fn load_simulated(
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
) -> Result<Vec<ElementRecord>, CalibrationBenchError> {
    check(bench)?;
    let Fingertip {
        layout,
        projection,
        kernel,
    } = Fingertip::new(fingertip)?;
    let optics = OpticsModel::new(optics, &layout, &projection)?.drawing_only(kernel.pixels());
    let mut moments = vec![ElementMoments::default(); kernel.element_count()];
    let mut records = vec![ElementRecord::default(); kernel.element_count()];
    draw_loads(&optics, bench, |picture, loads| {
        kernel.measure(picture, &mut moments)?;
        for ((record, &load), &moments) in records.iter_mut().zip(loads).zip(&moments) {
            let sample = |force| LoadSample { force, moments };
            match load {
                Load::None => record.unloaded.push(moments),
                Load::Fitted(force) => record.fitted.push(sample(force)),
                Load::HeldOut(force) => record.held_out.push(sample(force)),
                Load::Cycled(force) => record.cycled.push(sample(force)),
            }
        }
        Ok::<_, CalibrationBenchError>(())
    })?;
    Ok(records)
}

/// Loads `fingertip` in simulation step by step, and passes each image and the loads on the elements to `take`.
///
/// All elements are loaded at the same time; each has separate loads in a separate order.
///
/// # Errors
/// If a configuration is invalid, or `take` fails.
pub fn take_pictures<E: From<CalibrationBenchError>>(
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
    take: impl FnMut(&Picture, &[Load]) -> Result<(), E>,
) -> Result<(), E> {
    check(bench)?;
    let (layout, projection) =
        Fingertip::layout_and_projection(fingertip).map_err(CalibrationBenchError::from)?;
    let optics =
        OpticsModel::new(optics, &layout, &projection).map_err(CalibrationBenchError::from)?;
    draw_loads(&optics, bench, take)
}

/// Renders images of all loads with `model` and passes them to `take`.
fn draw_loads<E: From<CalibrationBenchError>>(
    model: &OpticsModel,
    bench: &CalibrationBenchConfig,
    mut take: impl FnMut(&Picture, &[Load]) -> Result<(), E>,
) -> Result<(), E> {
    let (layout, projection) = (&model.layout, &model.projection);
    let mut scratch = OpticsScratch::new(model);
    let mut picture = Picture::black(projection.width(), projection.height());
    let mut rng = Pcg64::seed_from_u64(bench.seed);

    let elements = layout.elements.len();
    let programs: Vec<_> = (0..elements).map(|_| program(bench, &mut rng)).collect();
    for step in 0..programs.first().map_or(0, Vec::len) {
        let own = programs.iter().map(|program| program[step]);
        let loads = in_patches(layout, bench.contact_radius, own.collect(), &mut rng);
        let forces: Vec<_> = loads.iter().map(|load| load.force()).collect();
        render(model, &mut scratch, &forces, &mut rng, &mut picture)
            .map_err(CalibrationBenchError::from)?;
        take(&picture, &loads)?;
    }
    Ok(())
}

/// Checks the parameters of the loads.
fn check(bench: &CalibrationBenchConfig) -> Result<(), CalibrationBenchError> {
    for (name, value) in [
        ("largest_normal", bench.largest_normal),
        ("largest_friction", bench.largest_friction),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(CalibrationBenchError::NotPositive { name, value });
        }
    }
    let value = bench.contact_radius;
    if !(value.is_finite() && value >= 0.0) {
        return Err(CalibrationBenchError::Negative {
            name: "contact_radius",
            value,
        });
    }
    Ok(())
}
