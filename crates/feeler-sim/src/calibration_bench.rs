//! Calibrates a simulated fingertip as a laboratory would: known loads, pictures, least squares.

pub use super::bench_loads::Load;

use super::{
    bench_loads::{in_patches, program},
    optics::{OpticsScratch, render},
    optics_config::{OpticsConfig, OpticsError},
    optics_model::OpticsModel,
};
use feeler::sensor::{
    calibration::{Calibration, CalibrationError, FullScale, MadeFor},
    calibration_fit::{ElementRecord, LoadSample, ModelChoice, fit},
    fingertip::{Fingertip, FingertipConfig, FingertipError},
    frame::Picture,
    moments::ElementMoments,
    moments_config::MomentsError,
};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Which loads are put on each element.
///
/// The separable calibration cannot be right for all loads, so what it is fitted on matters. Most
/// loads lie inside the friction cone, as they do while a cap is screwed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CalibrationBenchConfig {
    /// Seed of the loads' order and of the camera's noise.
    pub seed: u64,
    /// Largest compression, N.
    pub largest_normal: f64,
    /// Largest shear force over compression, as a coefficient of friction.
    pub largest_friction: f64,
    /// Pictures without load.
    pub unloaded: usize,
    /// Loads of the sweep of compression alone, up to the largest.
    pub normal_sweep: usize,
    /// Loads of each of the two sweeps of shear, along x and along y, at half the largest normal.
    pub shear_sweep: usize,
    /// Combined loads, drawn from inside the friction cone.
    pub combined: usize,
    /// Further combined loads that are kept from the fit to find its error.
    pub held_out: usize,
    /// Times that each element is loaded and unloaded again, in steps up to half the largest
    /// compression and half its largest shear force, after everything else, to find repeatability
    /// and hysteresis.
    pub cycles: usize,
    /// Loads are put on patches of about this radius, m, as objects press on many elements of a skin at once; 0: on each element, whatever
    /// its neighbours bear.
    pub contact_radius: f64,
    /// Which model is fitted.
    pub model: ModelChoice,
    /// What shares of full scale refer to.
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
    /// For a fingertip: `combined` combined loads and other kinds in proportion. Where there are more than 41 elements, each bears less, so
    /// that all bear as much together; on a skin that moves as one, loads are put on patches of thrice its spread.
    pub fn of_fingertip(
        fingertip: &FingertipConfig,
        optics: &OpticsConfig,
        combined: usize,
    ) -> Self {
        /// Elements of the fingertip that the default is for.
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

/// Why a simulated fingertip cannot be calibrated.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationBenchError {
    /// The fingertip makes no sense.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// Its optics make no sense.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// No moments could be taken.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The loads do not determine a calibration.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// A length makes no sense.
    #[error("{name} must be a number of 0 or more, got {value}")]
    Negative {
        /// The field.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// A load makes no sense.
    #[error("{name} must be a positive number, got {value}")]
    NotPositive {
        /// The field.
        name: &'static str,
        /// What it was.
        value: f64,
    },
}

/// Calibrates the simulated fingertip `fingertip` with the optics `optics`.
///
/// # Errors
/// When a configuration makes no sense, or its loads do not determine a calibration.
pub fn calibrate_simulated(
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
) -> Result<Calibration, CalibrationBenchError> {
    let records = load_simulated(fingertip, optics, bench)?;
    let made_for = MadeFor::fingertip(fingertip)?;
    Ok(fit(made_for, &records, bench.model, bench.full_scale)?)
}

/// Loads the simulated fingertip `fingertip` and takes its moments.
///
/// # Errors
/// When a configuration makes no sense.
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

/// Loads the simulated fingertip `fingertip` step by step and hands over each picture with what is
/// on its elements.
///
/// All elements are loaded at once, each with its own loads in its own order.
///
/// # Errors
/// When a configuration makes no sense, or what `take` says.
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

/// Hands over the pictures that `model` draws of all loads.
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

/// Refuses loads that make no sense.
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
