//! Fits a calibration to known loads and their moments: chooses the model and its terms, and measures the accuracy.

use super::coupled::orders::choose_orders;
use super::coupled::{CoupledMap, Orders};
use super::element::{ElementCalibration, ForceMap};
use super::error::{CALIBRATION_VERSION, CalibrationError};
use super::model::{Calibration, ForceUnit};
use super::quality::{
    CycledReading, ElementQuality, FullScale, HeldOutError, repeatability_and_hysteresis,
    resolution,
};
use super::relative_moments::RelativeMoments;
use super::separable::SeparableMap;
use crate::sensor::fingertip::made_for::CalibrationTarget;
use crate::sensor::image::folds::Folds;
use crate::sensor::moments::kernel::ElementMoments;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// A known load on one element and the moments under it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadSample {
    /// Load in the element's frame `E_i`, N (sign as in [`TactileFrame`](crate::sensor::forces::reading::TactileFrame)).
    pub force: DVec3,
    /// Moments of the element under the load.
    pub moments: ElementMoments,
}

/// Measurements for calibrating one element.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementRecord {
    /// Moments without load; their mean is the unloaded reference.
    pub unloaded: Vec<ElementMoments>,
    /// Loads for the fit.
    pub fitted: Vec<LoadSample>,
    /// Loads for measuring the error, excluded from the fit. If empty, the error is cross-validated: each fitted load
    /// is predicted by a fit to the other four fifths of the loads.
    pub held_out: Vec<LoadSample>,
    /// Repeated loads, in order, for measuring repeatability and hysteresis; excluded from the fit.
    pub cycled: Vec<LoadSample>,
}

/// Choice of the model to fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelChoice {
    /// The paper's model: one curve for each component of the force.
    #[default]
    Separable,
    /// Each component as a function of all moments.
    Coupled,
    /// The model with the smaller cross-validated error over all elements.
    Auto,
}

impl FullScale {
    /// Full scale from the largest load in `records`, rounded up to the millinewton; the default if there are no
    /// loads.
    pub fn of_loads(records: &[ElementRecord]) -> Self {
        let largest = |of: fn(DVec3) -> f64, default: f64| {
            let loads = records.iter().flat_map(|record| &record.fitted);
            match loads.map(|sample| of(sample.force)).fold(0.0, f64::max) {
                largest if largest > 0.0 => (1e3 * largest).ceil() / 1e3,
                _ => default,
            }
        };
        let default = Self::default();
        Self {
            normal: largest(|force| force.z.abs(), default.normal),
            shear: largest(|force| force.truncate().length(), default.shear),
        }
    }
}

/// Fits a calibration to `records`, one for each element of `made_for`.
///
/// # Errors
/// If a record is missing or empty, an element is dark, or its loads are insufficient for a fit.
pub fn fit(
    made_for: CalibrationTarget,
    records: &[ElementRecord],
    choice: ModelChoice,
    full_scale: FullScale,
) -> Result<Calibration, CalibrationError> {
    let expected = made_for.elements;
    if records.len() != expected {
        return Err(CalibrationError::ElementCount {
            what: "records of loads",
            expected,
            actual: records.len(),
        });
    }
    let fit_all = |coupled: bool| -> Result<Fitted, CalibrationError> {
        let mut all = Fitted::default();
        for (element, record) in records.iter().enumerate() {
            let unusable = |what| CalibrationError::Unusable { element, what };
            let prepared = Prepared::new(record).map_err(unusable)?;
            let (calibration, score) = prepared.fit(coupled, full_scale).map_err(unusable)?;
            all.elements.push(calibration);
            all.score += score;
        }
        Ok(all)
    };
    let fitted = match choice {
        ModelChoice::Separable => fit_all(false)?,
        ModelChoice::Coupled => fit_all(true)?,
        ModelChoice::Auto => {
            let separable = fit_all(false);
            match (fit_all(true), separable) {
                (Ok(coupled), Ok(separable)) if coupled.score <= separable.score => coupled,
                (Ok(coupled), Err(_)) => coupled,
                // If the coupled model cannot be fitted, the separable one is used.
                (_, separable) => separable?,
            }
        }
    };
    let calibration = Calibration {
        version: CALIBRATION_VERSION,
        force_unit: ForceUnit::Newton,
        full_scale,
        loads_confirmed: false,
        made_for,
        elements: fitted.elements,
    };
    calibration.check()?;
    Ok(calibration)
}

/// Coefficient of determination (R²) on the held-out loads, along x, y, z of the elements' frames, over all elements.
/// 1 is a perfect prediction, 0 is no better than predicting the mean load. 1 along axes without varying loads.
pub fn explained(calibration: &Calibration, records: &[ElementRecord]) -> DVec3 {
    let (mut errors, mut variance) = (DVec3::ZERO, DVec3::ZERO);
    for (element, record) in calibration.elements.iter().zip(records) {
        let loads = match record.held_out.is_empty() {
            true => &record.fitted,
            false => &record.held_out,
        };
        let count = loads.len() as f64;
        let mean = loads.iter().map(|load| load.force).sum::<DVec3>() / count.max(1.0);
        let squares = loads.iter().map(|load| (load.force - mean).powf(2.0));
        variance += squares.sum::<DVec3>();
        let rms = element.quality.held_out.rms;
        errors += count * rms * rms;
    }
    let part = |axis: usize| match variance[axis] > 0.0 {
        true => 1.0 - errors[axis] / variance[axis],
        false => 1.0,
    };
    DVec3::new(part(0), part(1), part(2))
}

/// Calibrations of all elements, fitted with the same model.
#[derive(Default)]
struct Fitted {
    elements: Vec<ElementCalibration>,
    /// Sum over elements of the mean squared cross-validated error, relative to full scale.
    score: f64,
}

/// Loads and moments of one element, prepared for fitting.
pub(super) struct Prepared<'a> {
    record: &'a ElementRecord,
    unloaded_gray: f64,
    unloaded_centroid: DVec2,
    pub inputs: Vec<RelativeMoments>,
    pub forces: Vec<DVec3>,
    pub folds: Folds,
}

impl<'a> Prepared<'a> {
    pub fn new(record: &'a ElementRecord) -> Result<Self, String> {
        if record.unloaded.is_empty() {
            return Err("expected at least 1 unloaded image, got none".into());
        }
        let pictures = record.unloaded.len() as f64;
        let grays = record.unloaded.iter().map(|m| m.integrated_gray);
        let unloaded_gray = grays.sum::<f64>() / pictures;
        let unloaded_centroid =
            record.unloaded.iter().map(|m| m.centroid).sum::<DVec2>() / pictures;
        if !(unloaded_gray > 0.0 && unloaded_gray.is_finite() && unloaded_centroid.is_finite()) {
            return Err(format!(
                "expected an element that is lit without load, got an integrated gray value of \
                 {unloaded_gray}"
            ));
        }
        let forces: Vec<_> = record.fitted.iter().map(|sample| sample.force).collect();
        check_forces(&forces)?;
        let prepared = Self {
            record,
            unloaded_gray,
            unloaded_centroid,
            inputs: Vec::new(),
            folds: Folds::new(&forces),
            forces,
        };
        let inputs = record.fitted.iter().map(|s| prepared.relative(&s.moments));
        Ok(Self {
            inputs: inputs.collect(),
            ..prepared
        })
    }

    pub fn relative(&self, moments: &ElementMoments) -> RelativeMoments {
        RelativeMoments::relative(moments, self.unloaded_gray, self.unloaded_centroid)
    }

    /// Fits one model to the element. Returns the calibration and its mean squared cross-validated error relative to
    /// full scale.
    fn fit(
        &self,
        coupled: bool,
        full_scale: FullScale,
    ) -> Result<(ElementCalibration, f64), String> {
        let orders = coupled.then(|| choose_orders(&self.inputs, &self.forces, &self.folds));
        let orders = orders.transpose()?;
        let map = fit_map(&self.inputs, &self.forces, orders)?;
        let validated = self.cross_validate(orders)?;
        let relative_errors = validated.iter().map(|e| e / full_scale.components());
        let score = relative_errors.map(DVec3::length_squared).sum::<f64>();
        let readings = |samples: &[LoadSample]| -> Vec<CycledReading> {
            let samples = samples.iter();
            samples
                .map(|sample| CycledReading {
                    force: sample.force,
                    reading: map.force(self.relative(&sample.moments)),
                })
                .collect()
        };
        let held_out = match readings(&self.record.held_out) {
            none if none.is_empty() => HeldOutError::of(&validated, full_scale),
            some => {
                let errors: Vec<_> = some.iter().map(|r| r.reading - r.force).collect();
                HeldOutError::of(&errors, full_scale)
            }
        };
        let (repeatability, hysteresis) =
            repeatability_and_hysteresis(&readings(&self.record.cycled));
        let unloaded = self.record.unloaded.iter();
        let unloaded: Vec<_> = unloaded.map(|m| map.force(self.relative(m))).collect();
        let quality = ElementQuality {
            held_out,
            repeatability,
            hysteresis,
            resolution: resolution(&unloaded),
        };
        let calibration = ElementCalibration {
            unloaded_gray: self.unloaded_gray,
            unloaded_centroid: self.unloaded_centroid,
            map,
            quality,
        };
        Ok((calibration, score / validated.len() as f64))
    }

    /// Error of each fitted load when predicted by a fit to the other folds, N, in the order of the folds.
    pub fn cross_validate(&self, orders: Option<Orders>) -> Result<Vec<DVec3>, String> {
        let mut errors = Vec::with_capacity(self.forces.len());
        for fold in self.folds.all() {
            let train = self.folds.others(fold);
            let inputs: Vec<_> = train.iter().map(|&row| self.inputs[row]).collect();
            let forces: Vec<_> = train.iter().map(|&row| self.forces[row]).collect();
            let map = fit_map(&inputs, &forces, orders)?;
            let own = self.folds.own(fold).into_iter();
            errors.extend(own.map(|row| map.force(self.inputs[row]) - self.forces[row]));
        }
        Ok(errors)
    }
}

pub(super) fn fit_map(
    inputs: &[RelativeMoments],
    forces: &[DVec3],
    orders: Option<Orders>,
) -> Result<ForceMap, String> {
    match orders {
        None => SeparableMap::fit(inputs, forces).map(ForceMap::Separable),
        Some(orders) => CoupledMap::fit(inputs, forces, orders).map(ForceMap::Coupled),
    }
}

/// Rejects loads that are insufficient for a fit.
fn check_forces(forces: &[DVec3]) -> Result<(), String> {
    if forces.is_empty() {
        return Err("expected loads, got none".into());
    }
    if let Some(force) = forces.iter().find(|force| !force.is_finite()) {
        return Err(format!("expected loads of finite forces, got {force} N"));
    }
    for (axis, name) in ["f_x", "f_y", "f_z"].into_iter().enumerate() {
        let first = forces[0][axis];
        if forces.iter().all(|force| force[axis] == first) {
            let count = forces.len();
            return Err(format!(
                "expected loads that vary {name}; all {count} have {first} N"
            ));
        }
    }
    Ok(())
}
