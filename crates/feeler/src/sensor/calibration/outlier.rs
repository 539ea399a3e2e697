//! Detects loads that contradict all other loads, such as mistyped ones.

use super::coupled::Orders;
use super::element::ForceMap;
use super::fit::{ElementRecord, Prepared, fit_map};
use super::model::Calibration;
use super::quality::root_mean_square;
use glam::DVec3;

/// Minimum number of loads of an element for outlier detection.
const MIN_LOADS: usize = 20;
/// Minimum ratio of an outlier's error to the robust standard deviation of the other loads' errors.
pub(in crate::sensor) const MISTYPED: f64 = 15.0;
/// Minimum ratio of an outlier's error to the root mean square of the other loads' errors.
const MISTYPED_RMS: f64 = 5.0;
/// Minimum error of an outlier, relative to the largest force of the other loads.
pub(in crate::sensor) const MIN_SHARE: f64 = 0.1;
/// Ratio of the standard deviation of a normal distribution to the median of its absolute values.
const DEVIATION_BY_MEDIAN: f64 = 1.4826;

/// A load that is far from the prediction by all other loads of its element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Index of the element.
    pub element: usize,
    /// Index of the load in the element's fitted loads.
    pub load: usize,
    /// Component of the force: 0 is x, 1 y, 2 z.
    pub axis: usize,
    /// Given value of the component, N.
    pub given: f64,
    /// Value predicted by the other loads, N.
    pub predicted: f64,
    /// Standard deviation of the other loads' errors, N.
    pub usual: f64,
}

impl Outlier {
    /// Returns whether the value is more than twice as large as any other load in `records`. Its image resembles those
    /// of the other loads and is therefore not the cause; the load would dominate the fit.
    pub fn is_beyond_all(&self, records: &[ElementRecord]) -> bool {
        let elements = records.iter().enumerate();
        let mut others = elements.flat_map(|(element, record)| {
            let loads = record.fitted.iter().enumerate();
            loads.filter(move |(load, _)| (element, *load) != (self.element, self.load))
        });
        others.all(|(_, sample)| self.given.abs() > 2.0 * sample.force.length())
    }

    /// Ratio of the error to the standard deviation.
    fn ratio(&self) -> f64 {
        (self.given - self.predicted).abs() / self.usual
    }
}

/// Finds the load that contradicts the other loads of its element most, if any: its error in a fit to the others
/// exceeds 15 robust standard deviations of theirs, 5 times their root mean square, and a tenth of their largest
/// force, although its moments are within the range of theirs. Also `None` if a fit without it fails.
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

/// Finds the outlier of one element. `orders` are the numbers of terms of a coupled model.
fn outlier_of(element: usize, record: &ElementRecord, orders: Option<Orders>) -> Option<Outlier> {
    if record.fitted.len() < MIN_LOADS {
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
    // The outlier distorts the fits that predict the others, so their errors are computed without it.
    let mut others = record.clone();
    let suspect = others.fitted.remove(load);
    let prepared = Prepared::new(&others).ok()?;
    let errors = prepared.cross_validate(orders).ok()?;
    let (usual, rms) = (deviation(&errors), root_mean_square(&errors));
    let map = fit_map(&prepared.inputs, &prepared.forces, orders).ok()?;
    let inputs = prepared.relative(&suspect.moments);
    let predicted = map.force(inputs);
    let error = (suspect.force - predicted).abs();
    let axis = (0..3).max_by(|&a, &b| (error / usual)[a].total_cmp(&(error / usual)[b]))?;
    let largest = prepared.forces.iter().map(|force| force.length());
    let least = MIN_SHARE * largest.fold(0.0, f64::max);
    let limit = (MISTYPED * usual).max(MISTYPED_RMS * rms)[axis].max(least);
    // A load outside the range of the others cannot be predicted from them.
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

/// Robust standard deviation of each component of `errors`, N; above zero.
fn deviation(errors: &[DVec3]) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| robust_deviation(errors.iter().map(|e| e[axis]))))
}

/// Robust standard deviation of `errors` about zero; above zero.
pub(in crate::sensor) fn robust_deviation(errors: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<_> = errors.map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    (DEVIATION_BY_MEDIAN * median).max(f64::MIN_POSITIVE)
}
