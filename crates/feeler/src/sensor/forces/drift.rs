//! Compensates drift of the lighting and slow creep of the moments between contacts.
//!
//! **Method.** A dimming lamp darkens all elements alike; a contact brightens a few. In every frame the elements are
//! sorted by `G / G_0`. The darkest group of at least a quarter of the elements that agree within a tolerance is
//! considered untouched, because pressing only brightens and touched elements rarely agree so closely. The group's
//! mean, low-pass filtered, is the common gain; `G` is divided by it. An element of that group whose centroid has not
//! moved either is considered unloaded; its offsets in gain and centroid are slowly re-zeroed within bounds.
//!
//! **Limitations.** If more than three quarters of the elements are touched, or no quarter agrees (for example because
//! most are dirty), the last gain is kept and further changes of the lamp appear as force. If a quarter or more are
//! pressed equally and all others harder, that quarter is considered untouched. The reading of an element that gets
//! dirty while touched, or suddenly by more than the tolerance, is wrong until it is recalibrated. A press that is
//! slower and weaker than the tolerances is re-zeroed like creep, up to the bounds. A sudden change of light is
//! compensated with the filter's delay.

use crate::check::Checker;
use crate::sensor::calibration::model::Calibration;
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Parameters for distinguishing drift from contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DriftConfig {
    /// Maximum difference of `G / G_0` among untouched elements; about ten times its noise.
    pub tolerance: f64,
    /// Maximum displacement of the centroid from its offset for an element to count as unmoved, as a fraction of the
    /// calibration's range of displacements.
    pub displacement_tolerance: f64,
    /// Weight of the latest frame in the low-pass filter of the common gain, 0 to 1.
    pub gain_rate: f64,
    /// Weight of the latest frame in the low-pass filter of an untouched element's offsets, 0 to 1; 0 disables
    /// re-zeroing.
    pub rezero_rate: f64,
}

impl Default for DriftConfig {
    fn default() -> Self {
        Self {
            tolerance: 0.03,
            displacement_tolerance: 0.02,
            gain_rate: 0.2,
            rezero_rate: 0.002,
        }
    }
}

impl DriftConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let shares = [
            ("tolerance", self.tolerance),
            ("displacement_tolerance", self.displacement_tolerance),
            ("gain_rate", self.gain_rate),
            ("rezero_rate", self.rezero_rate),
        ];
        for (field, share) in shares {
            checker.between(&format!("{key}.{field}"), share, 0.0, 1.0);
        }
    }
}

/// Offsets of one unloaded element relative to its calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rest {
    /// Integrated gray value without load at calibration.
    calibrated_gray: f64,
    /// Centroid without load at calibration.
    calibrated_centroid: DVec2,
    /// Maximum displacement for the element to count as not moved, m (or px).
    unmoved: f64,
    /// `G / G_0` relative to the common gain.
    gain: f64,
    /// Displacement of the centroid, m (or px).
    displacement: DVec2,
}

/// Maximum correction of the gain of a single element.
const LARGEST_OWN_GAIN: f64 = 0.05;

/// Stage between moments and calibration that removes drift; see the module documentation.
#[derive(Debug, Clone)]
pub struct DriftCorrection {
    config: DriftConfig,
    rests: Vec<Rest>,
    /// `G / G_0` of the elements in this frame, in increasing order.
    ratios: Vec<f64>,
    gain: Option<f64>,
}

impl DriftCorrection {
    /// Creates a correction for the fingertip of `calibration`.
    pub fn new(config: DriftConfig, calibration: &Calibration) -> Self {
        let rests: Vec<_> = (calibration.elements.iter())
            .map(|element| {
                let [_, x, y] = element.map.ranges().map(|[low, high]| high - low);
                Rest {
                    calibrated_gray: element.unloaded_gray,
                    calibrated_centroid: element.unloaded_centroid,
                    unmoved: config.displacement_tolerance * x.min(y),
                    gain: 1.0,
                    displacement: DVec2::ZERO,
                }
            })
            .collect();
        Self {
            config,
            ratios: vec![0.0; rests.len()],
            rests,
            gain: None,
        }
    }

    /// Common gain of the lighting relative to the calibration; 1 until it is known.
    pub fn gain(&self) -> f64 {
        self.gain.unwrap_or(1.0)
    }

    /// Removes drift from the moments of one frame in place. Neither allocates nor panics.
    ///
    /// If the number of elements differs, surplus elements are ignored.
    pub fn correct(&mut self, moments: &mut [ElementMoments]) {
        self.follow_gain(moments);
        let gain = self.gain();
        for (rest, moments) in self.rests.iter_mut().zip(moments) {
            rest.rezero(moments, gain, &self.config);
            moments.integrated_gray /= gain * rest.gain;
            moments.centroid -= rest.displacement;
        }
    }

    /// Updates the common gain from the untouched elements, if there are enough.
    fn follow_gain(&mut self, moments: &[ElementMoments]) {
        let elements = self.rests.iter().zip(moments);
        for ((rest, moments), ratio) in elements.zip(&mut self.ratios) {
            *ratio = moments.integrated_gray / (rest.calibrated_gray * rest.gain);
        }
        self.ratios.sort_unstable_by(f64::total_cmp);
        let Some(newest) = untouched_gain(&self.ratios, self.config.tolerance) else {
            return;
        };
        let before = self.gain.unwrap_or(newest);
        self.gain = Some(before + self.config.gain_rate * (newest - before));
    }
}

impl Rest {
    /// Moves the element's offsets towards the current moments if it is certainly untouched.
    fn rezero(&mut self, moments: &ElementMoments, gain: f64, config: &DriftConfig) {
        let own = moments.integrated_gray / (self.calibrated_gray * gain);
        let displacement = moments.centroid - self.calibrated_centroid;
        let untouched = (own - self.gain).abs() <= config.tolerance
            && (displacement - self.displacement).length() <= self.unmoved;
        if untouched {
            let rate = config.rezero_rate;
            let gain = self.gain + rate * (own - self.gain);
            self.gain = gain.clamp(1.0 - LARGEST_OWN_GAIN, 1.0 + LARGEST_OWN_GAIN);
            let moved = self.displacement + rate * (displacement - self.displacement);
            self.displacement = moved.clamp_length_max(2.0 * self.unmoved);
        }
    }
}

/// Mean of the first group of ratios that agree within `tolerance` and are at least a quarter of all. `rising` are the
/// ratios in increasing order. `None` if there is no such group.
fn untouched_gain(rising: &[f64], tolerance: f64) -> Option<f64> {
    let least = rising.len().div_ceil(4).max(1);
    let start = (rising.windows(least)).position(|window| match window {
        [first, .., last] => agree(*first, *last, tolerance),
        [only] => agree(*only, *only, tolerance),
        [] => false,
    })?;
    let rest = rising.get(start..)?;
    let first = rest.first()?;
    let group = rest
        .iter()
        .take_while(|&&ratio| agree(*first, ratio, tolerance));
    let (sum, count) = group.fold((0.0, 0.0), |(sum, count), ratio| (sum + ratio, count + 1.0));
    Some(sum / count)
}

/// Returns whether two ratios in increasing order are within the tolerance; always `false` for dark elements.
fn agree(low: f64, high: f64, tolerance: f64) -> bool {
    /// Minimum gain of a working lamp; below, the image is dark.
    const DARK: f64 = 0.3;
    low > DARK && high.is_finite() && high - low <= tolerance * low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_darkest_quarter_that_agrees_is_untouched() {
        let gain = |ratios: &[f64]| untouched_gain(ratios, 0.03);
        let close = |gain: Option<f64>, expected: f64| {
            assert!(
                gain.is_some_and(|g| (g - expected).abs() < 1e-12),
                "{gain:?}"
            );
        };
        close(gain(&[0.9; 12]), 0.9);
        // Nine of twelve elements are pressed differently; one is dirty.
        let mut pressed = vec![0.5, 0.9, 0.9, 0.9, 1.2, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0];
        close(gain(&pressed), 0.9);
        pressed[3] = 1.1;
        assert_eq!(gain(&pressed), None);
        assert_eq!(gain(&[0.0; 12]), None);
        assert_eq!(gain(&[f64::NAN; 12]), None);
        assert_eq!(gain(&[]), None);
    }
}
