//! Calibration of a simulated fingertip as in a laboratory: known loads, images, least squares.

pub use super::loads::Load;

use super::loads::{in_patches, program};
use crate::optics::config::{OpticsConfig, OpticsError};
use crate::optics::model::OpticsModel;
use crate::optics::renderer::{OpticsScratch, render};
use feeler::sensor::calibration::{
    Calibration, CalibrationError, CalibrationTarget, ElementRecord, FullScale, LoadSample,
    ModelChoice, fit,
};
use feeler::sensor::fingertip::{Fingertip, FingertipConfig, FingertipError};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::{ElementMoments, MomentsError};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Loads that are applied to each element.
///
/// The separable model cannot fit all loads, so their selection matters. Most are inside the friction cone, as they are
/// while a cap is turned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CalibrationBenchConfig {
    /// Seed of the order of loads and of the camera's noise.
    pub seed: u64,
    /// Maximum compression (N).
    pub largest_normal: f64,
    /// Maximum ratio of shear force to compression, like a friction coefficient.
    pub largest_friction: f64,
    /// Number of images without load.
    pub unloaded: usize,
    /// Number of loads of pure compression, up to the maximum.
    pub normal_sweep: usize,
    /// Number of loads in each of two sweeps of shear, along x and y, at half the maximum compression.
    pub shear_sweep: usize,
    /// Number of combined loads, random inside the friction cone.
    pub combined: usize,
    /// Number of additional combined loads that are held out from the fit for validation.
    pub held_out: usize,
    /// Number of load cycles of each element at the end, for repeatability and hysteresis: in steps up to half the
    /// maximum compression and half of its maximum shear force.
    pub cycles: usize,
    /// Approximate radius of the patches to which loads are applied (m), as objects press on several elements of a
    /// skin. With 0, elements are loaded independently.
    pub contact_radius: f64,
    /// Model to fit.
    pub model: ModelChoice,
    /// Full scale that relative errors refer to.
    pub full_scale: FullScale,
}

impl Default for CalibrationBenchConfig {
    fn default() -> Self {
        Self {
            seed: 1,
            largest_normal: 2.0,
            largest_friction: 0.9,
            unloaded: 32,
            normal_sweep: 40,
            shear_sweep: 40,
            combined: 400,
            held_out: 200,
            cycles: 8,
            contact_radius: 0.0,
            model: ModelChoice::Separable,
            full_scale: FullScale::default(),
        }
    }
}

impl CalibrationBenchConfig {
    /// Configuration for a fingertip with `combined` combined loads, and loads of other kinds in proportion. With more than 41 elements,
    /// forces are reduced so that the total force stays the same. On a skin with markers, the radius of patches is
    /// three times its spread.
    pub fn of_fingertip(
        fingertip: &FingertipConfig,
        optics: &OpticsConfig,
        combined: usize,
    ) -> Self {
        /// Number of elements for which the default values are chosen.
        const ELEMENTS: f64 = 41.0;
        let default = Self::default();
        let share = |count: usize| (count * combined).div_ceil(default.combined);
        let elements = fingertip.layout.element_count().max(1) as f64;
        let largest_normal = default.largest_normal * (ELEMENTS / elements).min(1.0);
        Self {
            largest_normal,
            contact_radius: optics
                .markers
                .as_ref()
                .map_or(0.0, |markers| 3.0 * markers.spread),
            full_scale: FullScale {
                normal: largest_normal,
                shear: 0.5 * largest_normal,
            },
            combined,
            unloaded: share(default.unloaded).max(2),
            normal_sweep: share(default.normal_sweep),
            shear_sweep: share(default.shear_sweep),
            held_out: share(default.held_out),
            ..default
        }
    }
}

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
        /// Its value.
        value: f64,
    },
    /// A parameter of the loads is not positive or not finite.
    #[error("{name} must be positive, got {value}")]
    NotPositive {
        /// Name of the field.
        name: &'static str,
        /// Its value.
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

/// Loads `fingertip` in simulation step by step and passes each image to `take`, with the loads on the elements.
///
/// All elements are loaded at the same time, each with its own loads in its own order.
///
/// # Errors
/// If a configuration is invalid, or an error of `take`.
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
