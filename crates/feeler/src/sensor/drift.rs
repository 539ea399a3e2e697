//! Takes out of the moments what the lamp and slow creep put in, between two touches.
//!
//! **How it works.** A lamp that dims makes all elements darker alike; a touch makes a few brighter.
//! In every frame the elements are ordered by `G / G_0`, and the darkest group of at least a quarter of
//! them that agree within a tolerance is taken for untouched: pressing only brightens, and touched
//! elements hardly agree so well. The group's mean is the common gain, followed with a lag against
//! noise, and `G` is divided by it. An element of that group whose centroid has not moved either is
//! unloaded beyond doubt; its own rest, in gain and centroid, is slowly re-zeroed within bounds.
//!
//! **When it cannot work.** Where more than three quarters of the elements are touched, or no quarter
//! agrees (a spot of dirt on most of them), the last gain is held and the lamp's further change counts as
//! force. Where a quarter or more are pressed equally hard and all the others harder, that quarter passes
//! for untouched. An element that is dirtied while touched, or at once by more than the tolerance, is off
//! until it is calibrated again. Under a press slower and weaker than the tolerances, re-zeroing
//! takes the press for creep, up to its bounds. A change of light within one frame is followed with the lag.

use super::{calibration::Calibration, moments::ElementMoments};
use crate::check::Checker;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// How drift is told from touch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DriftConfig {
    /// Part of `G / G_0` by which untouched elements may differ, about ten times its noise.
    pub tolerance: f64,
    /// Displacement of the centroid from its rest up to which an element counts as unmoved, in shares of
    /// the range of displacements that the calibration knows.
    pub displacement_tolerance: f64,
    /// Part of the way to the newest gain that is gone in each frame, 0 to 1.
    pub gain_rate: f64,
    /// Part of the way to the newest rest that an untouched element goes in each frame; 0: never.
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
    /// Requires every value of the table `key` to be in its range.
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

/// What one element shows without load, relative to its calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rest {
    /// Integrated gray value without load when calibrated.
    calibrated_gray: f64,
    /// Centroid without load when calibrated.
    calibrated_centroid: DVec2,
    /// Displacement up to which it counts as unmoved, m (or px).
    unmoved: f64,
    /// `G / G_0` relative to the common gain.
    gain: f64,
    /// Displacement of the centroid, m (or px).
    displacement: DVec2,
}

/// Most by which an element's own gain may be re-zeroed.
const LARGEST_OWN_GAIN: f64 = 0.05;

/// A stage between moments and calibration; see the module.
#[derive(Debug, Clone)]
pub struct DriftCorrection {
    config: DriftConfig,
    rests: Vec<Rest>,
    /// `G / G_0` of the elements in this frame, in rising order.
    ratios: Vec<f64>,
    gain: Option<f64>,
}

impl DriftCorrection {
    /// For the fingertip of `calibration`.
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

    /// The common gain of the light relative to the calibration's; 1 before it is known.
    pub fn gain(&self) -> f64 {
        self.gain.unwrap_or(1.0)
    }

    /// Takes drift out of the moments of one frame, in place. Neither allocates nor panics.
    ///
    /// Moments of another number of elements are corrected as far as both go.
    pub fn correct(&mut self, moments: &mut [ElementMoments]) {
        self.follow_gain(moments);
        let gain = self.gain();
        for (rest, moments) in self.rests.iter_mut().zip(moments) {
            rest.rezero(moments, gain, &self.config);
            moments.integrated_gray /= gain * rest.gain;
            moments.centroid -= rest.displacement;
        }
    }

    /// Follows the common gain of the elements that are not touched, if there are enough.
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
    /// Goes a little way to what the element shows, if it is beyond doubt not touched.
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

/// Mean of the first run of at least a quarter of the `rising` ratios that lie within `tolerance` of
/// each other.
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

/// Whether two rising ratios are of elements in the same light; darkness is none.
fn agree(low: f64, high: f64, tolerance: f64) -> bool {
    /// Least gain that is a light's: below, the picture is dead.
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
        // Nine of twelve are pressed, each in its own way; one is dirty.
        let mut pressed = vec![0.5, 0.9, 0.9, 0.9, 1.2, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0];
        close(gain(&pressed), 0.9);
        pressed[3] = 1.1;
        assert_eq!(gain(&pressed), None);
        assert_eq!(gain(&[0.0; 12]), None);
        assert_eq!(gain(&[f64::NAN; 12]), None);
        assert_eq!(gain(&[]), None);
    }
}
