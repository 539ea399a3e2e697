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

use super::basis::Basis;
use super::calibration::{LARGEST, check_count, check_number};
use super::error::WrenchError;
use crate::sensor::forces::sensing::ElementReading;
use crate::sensor::image::exposure::Exposure;
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec2;
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
    /// Indices of the used features among the [`PER_ELEMENT`] of an element.
    fn kinds(self) -> impl Iterator<Item = usize> + Clone {
        let growth = match self.growth {
            Growth::Ignored => None,
            Growth::GainFree => Some(0),
            Growth::Plain => Some(1),
        };
        let displacement = if self.displacement { 2..4 } else { 0..0 };
        growth.into_iter().chain(displacement)
    }
}

/// Returns 0 for a missing feature, so that it has no effect.
pub(super) fn or_nothing(feature: f64) -> f64 {
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

    fn check(&self, index: usize) -> Result<(), WrenchError> {
        let field = |name: &str| format!("model.elements[{index}].{name}");
        if self.used {
            // A tiny value would make growth overflow.
            check_number(&field("gray"), self.gray, 1e-100..=LARGEST)?;
        }
        for place in self.centroid.to_array() {
            check_number(&field("centroid"), place, -LARGEST..=LARGEST)?;
        }
        for (mean, scale) in self.mean.into_iter().zip(self.scale) {
            check_number(&field("mean"), mean, -LARGEST..=LARGEST)?;
            check_number(&field("scale"), scale, 0.0..=LARGEST)?;
        }
        Ok(())
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

/// Statistics of the elements of a camera's sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MomentBasis(pub Vec<ElementStandard>);

impl Basis for MomentBasis {
    const KIND: &'static str = "wrench";
    const MAX_ROWS: usize = 400;
    /// Moments of the elements in one image; `None` for elements that are dark or saturated.
    type Input = Vec<Option<ElementMoments>>;
    type Terms = Terms;

    fn elements_of(input: &Self::Input) -> usize {
        input.len()
    }

    fn learn(elements: usize, inputs: &[&Self::Input]) -> Self {
        Self(standards(elements, inputs))
    }

    fn missing_input(&self) -> Self::Input {
        vec![None; self.0.len()]
    }

    fn feature_count(&self) -> usize {
        PER_ELEMENT * self.0.len()
    }

    fn standardise(&self, input: &Self::Input, features: &mut [f64]) -> f64 {
        features.fill(f64::NAN);
        let Some(gain) = common_gain(&self.0, input) else {
            return 1.0;
        };
        let (mut used, mut missing) = (0.0, 0.0);
        let (features, _) = features.as_chunks_mut::<PER_ELEMENT>();
        for ((standard, moments), features) in self.0.iter().zip(input).zip(features) {
            if !standard.used {
                continue;
            }
            used += 1.0;
            match moments {
                Some(moments) => *features = standard.standardised(standard.raw(moments, gain)),
                None => missing += 1.0,
            }
        }
        missing / used
    }

    fn candidates(&self) -> Vec<Terms> {
        let terms = |growth, displacement, squares| Terms {
            growth,
            displacement,
            squares,
        };
        let kinds = [
            (Growth::GainFree, false),
            (Growth::Ignored, true),
            (Growth::GainFree, true),
            (Growth::Plain, false),
            (Growth::Plain, true),
        ];
        let separable = self.used() >= MIN_FOR_GAIN;
        let kinds = kinds
            .into_iter()
            .filter(|(growth, _)| separable || *growth != Growth::GainFree);
        let candidates = kinds.flat_map(|(growth, displacement)| {
            [false, true].map(|squares| terms(growth, displacement, squares))
        });
        candidates.collect()
    }

    /// Overall brightness drifts with the lamp.
    fn is_doubtful(terms: Terms, other: Terms) -> bool {
        terms.growth == Growth::Plain && other.growth != Growth::Plain
    }

    /// Growth and displacement of each element, independently of the terms of the components. Under an unusual load,
    /// spots may brighten as usual but move differently. Overall brightness is included if a component depends on it,
    /// or if there are too few elements to separate it from growth.
    fn watched(&self, chosen: &[Terms]) -> Terms {
        let plain = chosen.iter().any(|terms| terms.growth == Growth::Plain);
        Terms {
            growth: match plain || self.used() < MIN_FOR_GAIN {
                true => Growth::Plain,
                false => Growth::GainFree,
            },
            displacement: true,
            squares: false,
        }
    }

    fn can_watch(terms: Terms) -> bool {
        !terms.squares
    }

    fn describe(terms: Terms) -> String {
        let growth = match terms.growth {
            Growth::Ignored => None,
            Growth::GainFree => Some("growth"),
            Growth::Plain => Some("growth and overall brightness"),
        };
        let displacement = terms.displacement.then_some("displacement");
        let squares = terms.squares.then_some("their squares");
        let parts = [growth, displacement, squares].into_iter().flatten();
        parts.collect::<Vec<_>>().join(", ")
    }

    fn term_count(&self, terms: Terms) -> usize {
        let orders = if terms.squares { 2 } else { 1 };
        orders * terms.kinds().count() * self.0.len()
    }

    /// In this order: for each element its features, then their squares.
    fn terms<'a>(&'a self, terms: Terms, features: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let (features, _) = features.as_chunks::<PER_ELEMENT>();
        features.iter().flat_map(move |features| {
            let linear = terms.kinds().map(move |kind| or_nothing(features[kind]));
            let squares = terms.kinds().filter(move |_| terms.squares);
            linear.chain(squares.map(move |kind| square(features[kind])))
        })
    }

    fn check(&self, elements: usize) -> Result<(), WrenchError> {
        check_count("model.elements", elements, self.0.len())?;
        for (index, element) in self.0.iter().enumerate() {
            element.check(index)?;
        }
        Ok(())
    }
}

impl MomentBasis {
    /// Number of elements in use.
    fn used(&self) -> usize {
        self.0.iter().filter(|standard| standard.used).count()
    }
}

/// Moments of the elements in one image.
type Seen = [Option<ElementMoments>];

/// Reference and statistics of `elements` elements over `pictures`.
fn standards(elements: usize, pictures: &[&Vec<Option<ElementMoments>>]) -> Vec<ElementStandard> {
    let total = pictures.len();
    let mut standards: Vec<_> = (0..elements)
        .map(|element| {
            reference(
                pictures.iter().filter_map(|seen| *seen.get(element)?),
                total,
            )
        })
        .collect();
    let mut sums = vec![[[0.0; 3]; PER_ELEMENT]; elements];
    for seen in pictures {
        let Some(gain) = common_gain(&standards, seen) else {
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
fn common_gain(standards: &[ElementStandard], seen: &Seen) -> Option<f64> {
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
