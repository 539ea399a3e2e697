//! Accuracy of a calibration: errors, repeatability, hysteresis, resolution.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Reference forces for percentages of full scale, N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FullScale {
    /// Compression, N.
    pub normal: f64,
    /// Magnitude of the shear force, N.
    pub shear: f64,
}

impl Default for FullScale {
    /// 2 N of compression and 1 N of shear.
    fn default() -> Self {
        Self {
            normal: 2.0,
            shear: 1.0,
        }
    }
}

impl FullScale {
    /// Full scale along x, y, z of `E_i`, N.
    pub fn components(self) -> DVec3 {
        DVec3::new(self.shear, self.shear, self.normal)
    }

    /// Converts `force` to % of full scale.
    pub fn percent(self, force: DVec3) -> DVec3 {
        100.0 * force / self.components()
    }
}

/// Errors on loads excluded from the fit, along x, y, z of the element's frame `E_i`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldOutError {
    /// Root mean square, N.
    pub rms: DVec3,
    /// Largest magnitude, N.
    pub worst: DVec3,
    /// Root mean square, % of full scale.
    pub rms_percent: DVec3,
    /// Largest magnitude, % of full scale.
    pub worst_percent: DVec3,
}

impl HeldOutError {
    /// Computes root mean square and largest magnitude of `errors` (N).
    pub fn of(errors: &[DVec3], full_scale: FullScale) -> Self {
        let rms = root_mean_square(errors);
        let worst = errors.iter().fold(DVec3::ZERO, |w, e| w.max(e.abs()));
        Self {
            rms,
            worst,
            rms_percent: full_scale.percent(rms),
            worst_percent: full_scale.percent(worst),
        }
    }
}

/// Root mean square of each component of `errors`; 0 if `errors` is empty.
pub(in crate::sensor) fn root_mean_square(errors: &[DVec3]) -> DVec3 {
    let squares: DVec3 = errors.iter().map(|error| error * error).sum();
    (squares / errors.len().max(1) as f64).map(f64::sqrt)
}

/// Accuracy of one element, N, along x, y, z of its frame `E_i`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementQuality {
    /// Errors on loads excluded from the fit.
    pub held_out: HeldOutError,
    /// Largest standard deviation among readings under the same load (N), over loads applied at least three times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeatability: Option<DVec3>,
    /// Largest difference between the mean readings under the same load when reached from smaller and from larger
    /// loads, N. Not less than the noise of these means.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hysteresis: Option<DVec3>,
    /// Three standard deviations of the reading without load, N: the smallest detectable force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<DVec3>,
}

/// Three standard deviations of the forces (N) measured in unloaded images.
pub(super) fn resolution(unloaded: &[DVec3]) -> Option<DVec3> {
    Some(3.0 * deviation(unloaded, 2)?)
}

/// Standard deviation (N); `None` if there are fewer than `least` forces.
fn deviation(forces: &[DVec3], least: usize) -> Option<DVec3> {
    let count = forces.len() as f64;
    if forces.len() < least {
        return None;
    }
    let mean = forces.iter().sum::<DVec3>() / count;
    let squares: DVec3 = forces.iter().map(|f| (f - mean) * (f - mean)).sum();
    Some((squares / (count - 1.0)).map(f64::sqrt))
}

/// Applied load and reading at one step of a load series, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycledReading {
    /// Applied load.
    pub force: DVec3,
    /// Measured force.
    pub reading: DVec3,
}

/// Readings taken under the same load.
#[derive(Default)]
struct SameLoad {
    all: Vec<DVec3>,
    rising: Vec<DVec3>,
    falling: Vec<DVec3>,
}

/// Repeatability and hysteresis (N) of a series of loads in the order of application. `None` if no load was repeated
/// often enough, or none was reached from both sides.
pub fn repeatability_and_hysteresis(series: &[CycledReading]) -> (Option<DVec3>, Option<DVec3>) {
    let mut loads: BTreeMap<[u64; 3], SameLoad> = BTreeMap::new();
    let mut before = 0.0;
    for &CycledReading { force, reading } in series {
        let key = force.to_array().map(f64::to_bits);
        let load = loads.entry(key).or_default();
        load.all.push(reading);
        let magnitude = force.length();
        if magnitude > before {
            load.rising.push(reading);
        } else if magnitude < before {
            load.falling.push(reading);
        }
        before = magnitude;
    }
    let largest = |values: Vec<DVec3>| values.into_iter().reduce(DVec3::max);
    let mean = |v: &[DVec3]| (!v.is_empty()).then(|| v.iter().sum::<DVec3>() / v.len() as f64);
    let deviations = loads.values().filter_map(|load| deviation(&load.all, 3));
    let differences = loads.values().filter_map(|load| {
        // One reading in each direction shows noise, not hysteresis.
        let enough = load.rising.len() >= 2 && load.falling.len() >= 2;
        let difference = mean(&load.rising)? - mean(&load.falling)?;
        enough.then_some(difference.abs())
    });
    (
        largest(deviations.collect()),
        largest(differences.collect()),
    )
}
