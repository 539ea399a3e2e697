//! Regression features: standardised growth and displacement of every element.
//!
//! Features are relative to each element's mean over the images of the calibration, so that no unloaded image is
//! needed; the intercept absorbs the difference:
//!
//! ```text
//! growth         G/G_0 / m - 1      m = mean of G/G_0 over the elements: the image's common gain
//! plain growth   G/G_0 - 1
//! displacement   u_x, u_y = c - c_0
//! ```
//!
//! A dimming lamp changes `m` but not the growth, because a global gain is not a force. Only plain growth is affected.

use crate::sensor::forces::sensing::ElementReading;
use crate::sensor::image::exposure::Exposure;
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec2;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Number of features of one element: growth without common gain, plain growth, displacement along x and along y.
pub const PER_ELEMENT: usize = 4;

/// Minimum number of elements required to separate a common gain from the loads.
pub const MIN_FOR_GAIN: usize = 4;

/// Maximum fraction of elements that may be dark or saturated in an image used for fitting or prediction.
pub const MAX_MISSING: f64 = 0.1;

/// Maximum magnitude of a standardised feature, which keeps predictions finite for any input.
const FARTHEST: f64 = 1e6;
/// Magnitude at which the square of a standardised feature saturates. Squares model curvature within the calibrated
/// range; beyond it they would diverge.
const FARTHEST_SQUARED: f64 = 4.0;

/// Definition of growth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Growth {
    /// Growth is not used.
    Ignored,
    /// Relative to the common gain of the image: a dimming lamp has no effect.
    GainFree,
    /// Absolute: overall brightness counts, and a dimming lamp looks like a force.
    Plain,
}

/// Features used for the regression of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Use of each element's growth.
    pub growth: Growth,
    /// Use the displacement of each element.
    pub displacement: bool,
    /// Also use the squares of these features.
    pub squares: bool,
}

impl Terms {
    /// Number of terms for `elements` elements.
    pub fn count(self, elements: usize) -> usize {
        let kinds = self.kinds().count();
        let orders = if self.squares { 2 } else { 1 };
        orders * kinds * elements
    }

    /// Indices of the used features among the [`PER_ELEMENT`] of an element.
    pub fn kinds(self) -> impl Iterator<Item = usize> + Clone {
        let growth = match self.growth {
            Growth::Ignored => None,
            Growth::GainFree => Some(0),
            Growth::Plain => Some(1),
        };
        let displacement = if self.displacement { 2..4 } else { 0..0 };
        growth.into_iter().chain(displacement)
    }

    /// Returns the terms of standardised `features` in the order of the weights: for each element its features, then
    /// their squares. Missing features (NaN) give terms of 0, which have no effect. Does not allocate.
    pub fn of(self, features: &[[f64; PER_ELEMENT]]) -> impl Iterator<Item = f64> {
        features.iter().flat_map(move |features| {
            let linear = self.kinds().map(move |kind| or_nothing(features[kind]));
            let squares = self.kinds().filter(move |_| self.squares);
            linear.chain(squares.map(move |kind| square(features[kind])))
        })
    }
}

/// Standardised features of each row.
pub(super) type Features = [Vec<[f64; PER_ELEMENT]>];

/// Design matrix with one row of terms for each of `rows`.
pub(super) fn matrix(features: &Features, rows: &[usize], terms: Terms) -> DMatrix<f64> {
    let elements = rows.first().map_or(0, |&row| features[row].len());
    let values = rows.iter().flat_map(|&row| terms.of(&features[row]));
    DMatrix::from_row_iterator(rows.len(), terms.count(elements), values)
}

fn or_nothing(feature: f64) -> f64 {
    if feature.is_nan() { 0.0 } else { feature }
}

/// Square of a standardised feature, centred and scaled as for a normal distribution.
fn square(feature: f64) -> f64 {
    if feature.is_nan() {
        return 0.0;
    }
    let near = feature.clamp(-FARTHEST_SQUARED, FARTHEST_SQUARED);
    (near * near - 1.0) * std::f64::consts::FRAC_1_SQRT_2
}

/// Returns the moments of a reading, or `None` if they cannot be used.
pub fn usable(reading: &ElementReading) -> Option<ElementMoments> {
    let good = reading.exposure == Exposure::Good && reading.integrated_gray.is_finite();
    let centroid = reading
        .centroid
        .filter(|centroid| good && centroid.is_finite())?;
    (reading.integrated_gray > 0.0).then_some(ElementMoments {
        integrated_gray: reading.integrated_gray,
        centroid,
    })
}

/// Reference and statistics of one element over the images of the calibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementStandard {
    /// `true` if the element is used: it was lit and not saturated in at least half of the images.
    pub used: bool,
    /// Mean integrated gray value G_0, gray levels times m² (px² for a planar layout).
    pub gray: f64,
    /// Mean centroid c_0 of the element without load, in x, y of its plane (m; px if the layout has no dome).
    pub centroid: DVec2,
    /// Mean of each feature.
    pub mean: [f64; PER_ELEMENT],
    /// Standard deviation of each feature; 0 for a constant feature, which is not used.
    pub scale: [f64; PER_ELEMENT],
}

impl ElementStandard {
    const UNUSED: Self = Self {
        used: false,
        gray: 0.0,
        centroid: DVec2::ZERO,
        mean: [0.0; PER_ELEMENT],
        scale: [0.0; PER_ELEMENT],
    };

    fn standardised(&self, raw: [f64; PER_ELEMENT]) -> [f64; PER_ELEMENT] {
        std::array::from_fn(|kind| {
            if self.scale[kind] > 0.0 {
                ((raw[kind] - self.mean[kind]) / self.scale[kind]).clamp(-FARTHEST, FARTHEST)
            } else {
                0.0
            }
        })
    }

    /// Features before standardisation, for an image with common gain `gain`.
    fn raw(&self, moments: &ElementMoments, gain: f64) -> [f64; PER_ELEMENT] {
        let growth = moments.integrated_gray / self.gray;
        let displacement = moments.centroid - self.centroid;
        [
            growth / gain - 1.0,
            growth - 1.0,
            displacement.x,
            displacement.y,
        ]
    }
}

/// Moments of the elements in one image; `None` for elements that are dark or saturated.
pub type Seen = [Option<ElementMoments>];

/// Reference and statistics of `elements` elements over `pictures`.
pub(super) fn standards<'a>(
    elements: usize,
    pictures: impl Iterator<Item = &'a Seen> + Clone,
) -> Vec<ElementStandard> {
    let total = pictures.clone().count();
    let mut standards: Vec<_> = (0..elements)
        .map(|element| {
            reference(
                pictures.clone().filter_map(|seen| *seen.get(element)?),
                total,
            )
        })
        .collect();
    let mut sums = vec![[[0.0; 3]; PER_ELEMENT]; elements];
    for seen in pictures {
        let Some(gain) = common_gain(&standards, seen.iter().copied()) else {
            continue;
        };
        for (element, moments) in seen.iter().enumerate() {
            let Some(moments) = moments.filter(|_| standards[element].used) else {
                continue;
            };
            let raw = standards[element].raw(&moments, gain);
            for (sum, value) in sums[element].iter_mut().zip(raw) {
                for (sum, power) in sum.iter_mut().zip([1.0, value, value * value]) {
                    *sum += power;
                }
            }
        }
    }
    for (standard, sums) in standards.iter_mut().zip(sums) {
        for (kind, [count, first, second]) in sums.into_iter().enumerate() {
            let mean = first / f64::max(count, 1.0);
            let variance = (second / f64::max(count, 1.0) - mean * mean).max(0.0);
            let scale = variance.sqrt();
            standard.mean[kind] = mean;
            // Rounding errors are not a scale.
            let least = 1e-9 * (1.0 + mean.abs());
            standard.scale[kind] = if scale > least { scale } else { 0.0 };
        }
    }
    standards
}

/// Mean of an element's moments, if at least half of `total` images contain them.
fn reference(moments: impl Iterator<Item = ElementMoments>, total: usize) -> ElementStandard {
    let (mut count, mut gray, mut centroid) = (0, 0.0, DVec2::ZERO);
    for moments in moments {
        count += 1;
        gray += moments.integrated_gray;
        centroid += moments.centroid;
    }
    if count == 0 || 2 * count < total {
        return ElementStandard::UNUSED;
    }
    ElementStandard {
        used: true,
        gray: gray / count as f64,
        centroid: centroid / count as f64,
        ..ElementStandard::UNUSED
    }
}

/// Mean of G/G_0 over the elements that are used and visible, or `None` if there are no such elements.
fn common_gain(
    standards: &[ElementStandard],
    seen: impl Iterator<Item = Option<ElementMoments>>,
) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (standard, moments) in standards.iter().zip(seen) {
        if let Some(moments) = moments.filter(|_| standard.used) {
            sum += moments.integrated_gray / standard.gray;
            count += 1.0;
        }
    }
    let gain = sum / count;
    (gain.is_finite() && gain > 0.0).then_some(gain)
}

/// Fills `features` with standardised features, or NaN for elements that are not used or not visible. Returns the
/// fraction of used elements that are not visible, or 1 if no element is. Neither allocates nor panics.
pub fn standardise(
    standards: &[ElementStandard],
    seen: impl Iterator<Item = Option<ElementMoments>> + Clone,
    features: &mut [[f64; PER_ELEMENT]],
) -> f64 {
    features.fill([f64::NAN; PER_ELEMENT]);
    let Some(gain) = common_gain(standards, seen.clone()) else {
        return 1.0;
    };
    let (mut used, mut missing) = (0.0, 0.0);
    for ((standard, moments), features) in standards.iter().zip(seen).zip(features) {
        if !standard.used {
            continue;
        }
        used += 1.0;
        match moments {
            Some(moments) => *features = standard.standardised(standard.raw(&moments, gain)),
            None => missing += 1.0,
        }
    }
    missing / used
}
