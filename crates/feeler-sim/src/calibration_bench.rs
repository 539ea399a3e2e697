//! Calibrates a simulated fingertip as a laboratory would: known loads, pictures, least squares.

use super::{
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
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

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
            model: ModelChoice::Separable,
            full_scale: FullScale::default(),
        }
    }
}

impl CalibrationBenchConfig {
    /// As the default but for `combined` combined loads, and other kinds in proportion.
    pub fn of_size(combined: usize) -> Self {
        let default = Self::default();
        let share = |count: usize| (count * combined).div_ceil(default.combined);
        Self {
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
    let kernel = Fingertip::new(fingertip)?.kernel;
    let mut moments = vec![ElementMoments::default(); kernel.element_count()];
    let mut records = vec![ElementRecord::default(); kernel.element_count()];
    take_pictures(fingertip, optics, bench, |picture, loads| {
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
    mut take: impl FnMut(&Picture, &[Load]) -> Result<(), E>,
) -> Result<(), E> {
    check(bench)?;
    let (layout, projection) =
        Fingertip::layout_and_projection(fingertip).map_err(CalibrationBenchError::from)?;
    let model =
        OpticsModel::new(optics, &layout, &projection).map_err(CalibrationBenchError::from)?;
    let mut scratch = OpticsScratch::new(&model);
    let mut picture = Picture::black(projection.width(), projection.height());
    let mut rng = Pcg64::seed_from_u64(bench.seed);

    let elements = layout.elements.len();
    let programs: Vec<_> = (0..elements).map(|_| program(bench, &mut rng)).collect();
    for step in 0..programs.first().map_or(0, Vec::len) {
        let loads: Vec<_> = programs.iter().map(|program| program[step]).collect();
        let forces: Vec<_> = loads.iter().map(|load| load.force()).collect();
        render(&model, &mut scratch, &forces, &mut rng, &mut picture)
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
    Ok(())
}

/// What is done with one load on one element; the force in its frame `E_i`, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// There is none.
    None,
    /// It is for fitting.
    Fitted(DVec3),
    /// It is kept from the fit.
    HeldOut(DVec3),
    /// It is one of a cycle.
    Cycled(DVec3),
}

impl Load {
    /// The force in the element's frame `E_i`, N.
    pub fn force(self) -> DVec3 {
        match self {
            Self::None => DVec3::ZERO,
            Self::Fitted(force) | Self::HeldOut(force) | Self::Cycled(force) => force,
        }
    }
}

/// All loads for one element, in random order but for the cycles.
fn program(bench: &CalibrationBenchConfig, rng: &mut Pcg64) -> Vec<Load> {
    let mut loads = vec![Load::None; bench.unloaded];
    for step in 1..=bench.normal_sweep {
        let normal = bench.largest_normal * step as f64 / bench.normal_sweep as f64;
        loads.push(Load::Fitted(normal * DVec3::Z));
    }
    let normal = 0.5 * bench.largest_normal;
    for axis in [DVec3::X, DVec3::Y] {
        for step in 0..bench.shear_sweep {
            let along = 2.0 * (step as f64 + 0.5) / bench.shear_sweep as f64 - 1.0;
            let shear = along * bench.largest_friction * normal;
            loads.push(Load::Fitted(normal * DVec3::Z + shear * axis));
        }
    }
    for _ in 0..bench.combined {
        loads.push(Load::Fitted(load_in_friction_cone(bench, rng)));
    }
    for _ in 0..bench.held_out {
        loads.push(Load::HeldOut(load_in_friction_cone(bench, rng)));
    }
    loads.shuffle(rng);
    let peak = 0.5 * bench.largest_normal * (DVec3::Z + 0.5 * bench.largest_friction * DVec3::X);
    for _ in 0..bench.cycles {
        let steps = [0.5, 1.0, 0.5, 0.0];
        loads.extend(steps.map(|share| Load::Cycled(share * peak)));
    }
    loads
}

/// A load with equally likely compressions, directions and shares of the largest shear force.
fn load_in_friction_cone(bench: &CalibrationBenchConfig, rng: &mut Pcg64) -> DVec3 {
    let normal = bench.largest_normal * rng.random::<f64>();
    let shear = bench.largest_friction * normal * rng.random::<f64>();
    let direction = DVec2::from_angle(TAU * rng.random::<f64>());
    (shear * direction).extend(normal)
}
