//! Loads that all other loads contradict, as a mistyped one is.

use super::{Calibration, ElementRecord, Orders, Prepared};
use crate::sensor::calibration::ForceMap;
use crate::sensor::calibration_quality::root_mean_square;
use glam::DVec3;

/// Least loads of an element among which one can be told from the others.
const LEAST_LOADS: usize = 20;
/// An error this many times as large as the others usually are, and as their root mean square, is no error of the fit.
pub(in crate::sensor) const MISTYPED: f64 = 15.0;
const MISTYPED_RMS: f64 = 5.0;
/// Least error of a mistyped load relative to the largest force of the other loads.
pub(in crate::sensor) const LEAST_SHARE: f64 = 0.1;
/// Standard deviation of a normal distribution relative to the median of its absolute values.
const DEVIATION_BY_MEDIAN: f64 = 1.4826;

/// A load that is far from what all other loads of its element predict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Index of the element.
    pub element: usize,
    /// Index of the load among those that are fitted.
    pub load: usize,
    /// Component of the force: 0 is x, 1 y, 2 z.
    pub axis: usize,
    /// The component as it is given, N.
    pub given: f64,
    /// The component as the other loads predict it, N.
    pub predicted: f64,
    /// Standard deviation of the other loads' errors, N.
    pub usual: f64,
}

impl Outlier {
    /// Whether it is twice as large as any other load in `records`. Its picture is like theirs, so that it is no error of the picture; and it
    /// decides how all others are fitted.
    pub fn is_beyond_all(&self, records: &[ElementRecord]) -> bool {
        let elements = records.iter().enumerate();
        let mut others = elements.flat_map(|(element, record)| {
            let loads = record.fitted.iter().enumerate();
            loads.filter(move |(load, _)| (element, *load) != (self.element, self.load))
        });
        others.all(|(_, sample)| self.given.abs() > 2.0 * sample.force.length())
    }

    /// How many times as large as usual its error is.
    fn ratio(&self) -> f64 {
        (self.given - self.predicted).abs() / self.usual
    }
}

/// The load that contradicts the other loads of its element most, if any does: one whose error in a fit to the others is
/// more than 15 standard deviations of theirs, as robustly estimated, 5 times their root mean square and a tenth of their largest force,
/// though its picture is within the ranges of theirs. `None` too where a fit without it fails.
pub fn outlier(calibration: &Calibration, records: &[ElementRecord]) -> Option<Outlier> {
    let elements = calibration.elements.iter().zip(records).enumerate();
    let outliers = elements.filter_map(|(index, (element, record))| {
        let orders = match &element.map {
            ForceMap::Separable(_) => None,
            ForceMap::Coupled(map) => Some(map.orders()),
        };
        outlier_of(index, record, orders)
    });
    outliers.max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
}

/// The same for one element, whose model has these numbers of terms if it is coupled.
fn outlier_of(element: usize, record: &ElementRecord, orders: Option<Orders>) -> Option<Outlier> {
    if record.fitted.len() < LEAST_LOADS {
        return None;
    }
    let prepared = Prepared::new(record).ok()?;
    let errors = prepared.cross_validate(orders).ok()?;
    let usual = deviation(&errors);
    let loads = prepared
        .folds
        .all()
        .flat_map(|fold| prepared.folds.own(fold));
    let (load, _) = loads
        .zip(
            errors
                .iter()
                .map(|error| (error.abs() / usual).max_element()),
        )
        .filter(|(_, ratio)| ratio.is_finite())
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    // It has spoilt the fits that predict the others: they are judged without it.
    let mut others = record.clone();
    let suspect = others.fitted.remove(load);
    let prepared = Prepared::new(&others).ok()?;
    let errors = prepared.cross_validate(orders).ok()?;
    let (usual, rms) = (deviation(&errors), root_mean_square(&errors));
    let map = super::fit_map(&prepared.inputs, &prepared.forces, orders).ok()?;
    let inputs = prepared.relative(&suspect.moments);
    let predicted = map.force(inputs);
    let error = (suspect.force - predicted).abs();
    let axis = (0..3).max_by(|&a, &b| (error / usual)[a].total_cmp(&(error / usual)[b]))?;
    let largest = prepared.forces.iter().map(|force| force.length());
    let least = LEAST_SHARE * largest.fold(0.0, f64::max);
    let limit = (MISTYPED * usual).max(MISTYPED_RMS * rms)[axis].max(least);
    // What the picture of no other load shows is predicted of none.
    let is_mistyped = error[axis] > limit && map.covers(inputs, 0.0);
    is_mistyped.then_some(Outlier {
        element,
        load,
        axis,
        given: suspect.force[axis],
        predicted: predicted[axis],
        usual: usual[axis],
    })
}

/// Standard deviation of each component of `errors`, N, whatever a few of them are; above zero.
fn deviation(errors: &[DVec3]) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| robust_deviation(errors.iter().map(|e| e[axis]))))
}

/// Standard deviation of `errors` about zero, whatever a few of them are; above zero.
pub(in crate::sensor) fn robust_deviation(errors: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<_> = errors.map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    (DEVIATION_BY_MEDIAN * median).max(f64::MIN_POSITIVE)
}
