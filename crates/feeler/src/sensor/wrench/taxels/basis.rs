//! Regression features of a taxel array.

use super::memory::{TIME_CONSTANTS, TaxelInput};
use crate::sensor::wrench::WrenchError;
use crate::sensor::wrench::basis::Basis;
use crate::sensor::wrench::calibration::{LARGEST, check_count, check_number};
use crate::sensor::wrench::features::or_nothing;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Kind of regression terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaxelKind {
    /// The readings.
    Linear,
    /// The readings and their products.
    Quadratic,
    /// Direction and logarithm of the length of all readings together, and their products.
    Pattern,
}

/// Regression terms of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelTerms {
    /// Kind of terms.
    pub kind: TaxelKind,
    /// Also use the differences between the readings and their filters.
    pub memory: bool,
}

/// Mean and standard deviation of features over the samples of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statistics {
    /// Means.
    pub mean: Vec<f64>,
    /// Standard deviations; 0 for constant features, which are not used.
    pub scale: Vec<f64>,
}

/// Statistics of a taxel array's features.
///
/// A feature is missing (NaN) if its taxel is. The length |v| excludes missing taxels, so that the direction of the
/// others is exact only if all taxels are valid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelBasis {
    /// Length of the readings that is added to |v|², N or counts: a tenth of the root mean square length. It keeps the
    /// direction of weak readings from being noise.
    pub least: f64,
    /// Features in this order: readings x, y, z of each taxel; their direction; ln |v|; differences from the filters of
    /// each taxel and component, filter by filter.
    pub features: Statistics,
}

/// Fraction of the root mean square length that is [`TaxelBasis::least`].
const LEAST: f64 = 0.1;
/// Standard deviation of the memory terms relative to the others. Hysteresis is a small part of a reading, and a ridge
/// penalises the weights of smaller terms more.
const MEMORY: f64 = 0.1;
/// Magnitude at which a factor of a product saturates, in standard deviations. Products model curvature within the
/// calibrated range; beyond it they would diverge.
const FARTHEST_FACTOR: f64 = 4.0;
/// Maximum magnitude of a feature in standard deviations, which keeps predictions finite for any input.
const FARTHEST: f64 = 1e6;
/// Maximum number of taxels for which products are used.
const MAX_FOR_PRODUCTS: usize = 16;

impl TaxelBasis {
    /// Number of taxels. Each has 3 readings, 3 components of the direction, and 3 differences from each filter.
    fn taxels(&self) -> usize {
        self.features.mean.len().saturating_sub(1) / per_taxel()
    }

    /// Standardised features whose products are terms of `kind`, with the terms themselves.
    fn factors(&self, kind: TaxelKind, features: &[f64]) -> std::ops::Range<usize> {
        let readings = (3 * self.taxels()).min(features.len());
        match kind {
            TaxelKind::Linear | TaxelKind::Quadratic => 0..readings,
            TaxelKind::Pattern => readings..(2 * readings + 1).min(features.len()),
        }
    }
}

fn per_taxel() -> usize {
    6 + 3 * TIME_CONSTANTS.len()
}

/// Calls `take` with the index and value of each feature of `input` before standardisation.
fn each_feature(input: &TaxelInput, least: f64, mut take: impl FnMut(usize, f64)) {
    let valid = input.values.iter().filter(|value| !value.is_nan());
    let squares: f64 = valid.map(|value| value.length_squared()).sum();
    let length = (squares + least * least).sqrt();
    let values = input.values.iter().copied();
    let directions = values.clone().map(|value| value / length);
    let memory = (0..TIME_CONSTANTS.len()).flat_map(|constant| {
        let pairs = input.values.iter().zip(&input.slow);
        pairs.map(move |(&value, slow)| value - slow[constant])
    });
    let vectors = |vectors: &mut dyn Iterator<Item = DVec3>,
                   first: usize,
                   take: &mut dyn FnMut(usize, f64)| {
        for (index, vector) in vectors.enumerate() {
            for (axis, value) in vector.to_array().into_iter().enumerate() {
                take(first + 3 * index + axis, value);
            }
        }
    };
    let readings = 3 * input.values.len();
    vectors(&mut values.clone(), 0, &mut take);
    vectors(&mut { directions }, readings, &mut take);
    take(2 * readings, libm::log(length));
    vectors(&mut { memory }, 2 * readings + 1, &mut take);
}

impl Basis for TaxelBasis {
    const KIND: &'static str = "taxel_wrench";
    const MAX_ROWS: usize = 1000;
    type Input = TaxelInput;
    type Terms = TaxelTerms;

    fn elements_of(input: &TaxelInput) -> usize {
        input.values.len()
    }

    fn learn(elements: usize, inputs: &[&TaxelInput]) -> Self {
        let values = inputs.iter().flat_map(|input| &input.values);
        let squares: f64 = values
            .filter(|value| !value.is_nan())
            .map(|value| value.length_squared())
            .sum();
        // At least the smallest normal number: a direction of 0 is no problem, a division by 0 is.
        let least = LEAST * (squares / inputs.len().max(1) as f64).sqrt();
        let least = least.max(f64::MIN_POSITIVE.sqrt());
        let mut sums = vec![[0.0; 3]; per_taxel() * elements + 1];
        for input in inputs {
            each_feature(input, least, |index, value| {
                if value.is_nan() {
                    return;
                }
                for (sum, power) in sums[index].iter_mut().zip([1.0, value, value * value]) {
                    *sum += power;
                }
            });
        }
        let (mean, scale) = sums.into_iter().map(mean_and_scale).unzip();
        Self {
            least,
            features: Statistics { mean, scale },
        }
    }

    fn missing_input(&self) -> TaxelInput {
        let taxels = self.taxels();
        TaxelInput {
            values: vec![DVec3::NAN; taxels],
            slow: vec![[DVec3::ZERO; TIME_CONSTANTS.len()]; taxels],
        }
    }

    fn feature_count(&self) -> usize {
        self.features.mean.len()
    }

    fn standardise(&self, input: &TaxelInput, features: &mut [f64]) -> f64 {
        features.fill(f64::NAN);
        let Statistics { mean, scale } = &self.features;
        each_feature(input, self.least, |index, value| {
            let (Some(feature), Some(mean), Some(&scale)) =
                (features.get_mut(index), mean.get(index), scale.get(index))
            else {
                return;
            };
            *feature = match scale > 0.0 {
                true => ((value - mean) / scale).clamp(-FARTHEST, FARTHEST),
                false => 0.0,
            };
        });
        let missing = input.values.iter().filter(|value| value.is_nan()).count();
        missing as f64 / input.values.len().max(1) as f64
    }

    fn candidates(&self) -> Vec<TaxelTerms> {
        let kinds: &[TaxelKind] = match self.taxels() <= MAX_FOR_PRODUCTS {
            true => &[TaxelKind::Linear, TaxelKind::Quadratic, TaxelKind::Pattern],
            false => &[TaxelKind::Linear],
        };
        let memory = |&kind: &TaxelKind| [false, true].map(|memory| TaxelTerms { kind, memory });
        kinds.iter().flat_map(memory).collect()
    }

    fn watched(&self, _: &[TaxelTerms]) -> TaxelTerms {
        TaxelTerms {
            kind: TaxelKind::Linear,
            memory: false,
        }
    }

    fn can_watch(terms: TaxelTerms) -> bool {
        terms.kind == TaxelKind::Linear && !terms.memory
    }

    fn describe(terms: TaxelTerms) -> String {
        let kind = match terms.kind {
            TaxelKind::Linear => "readings",
            TaxelKind::Quadratic => "readings and their products",
            TaxelKind::Pattern => "direction and length of the readings, and their products",
        };
        let memory = if terms.memory { ", memory" } else { "" };
        format!("{kind}{memory}")
    }

    fn term_count(&self, terms: TaxelTerms) -> usize {
        let readings = 3 * self.taxels();
        let factors = match terms.kind {
            TaxelKind::Linear => readings,
            TaxelKind::Quadratic => readings + readings * (readings + 1) / 2,
            TaxelKind::Pattern => (readings + 1) * (readings + 4) / 2,
        };
        match terms.memory {
            true => factors + readings * TIME_CONSTANTS.len(),
            false => factors,
        }
    }

    /// In this order: features, their products, memory.
    fn terms<'a>(
        &'a self,
        terms: TaxelTerms,
        features: &'a [f64],
    ) -> impl Iterator<Item = f64> + 'a {
        let factors = &features[self.factors(terms.kind, features)];
        let products = match terms.kind {
            TaxelKind::Linear => 0,
            TaxelKind::Quadratic | TaxelKind::Pattern => factors.len(),
        };
        let factor =
            |place: usize| or_nothing(factors[place]).clamp(-FARTHEST_FACTOR, FARTHEST_FACTOR);
        let products = (0..products)
            .flat_map(move |first| (first..factors.len()).map(move |second| (first, second)))
            .map(move |(first, second)| factor(first) * factor(second));
        let memory = match terms.memory {
            true => &features[(6 * self.taxels() + 1).min(features.len())..],
            false => &[],
        };
        let memory = memory.iter().map(|&feature| MEMORY * or_nothing(feature));
        let linear = factors.iter().map(|&feature| or_nothing(feature));
        linear.chain(products).chain(memory)
    }

    fn check(&self, elements: usize) -> Result<(), WrenchError> {
        check_number("model.elements.least", self.least, 1e-200..=LARGEST)?;
        let Statistics { mean, scale } = &self.features;
        let expected = per_taxel() * elements + 1;
        for (name, values, low) in [("mean", mean, -LARGEST), ("scale", scale, 0.0)] {
            let name = format!("model.elements.features.{name}");
            check_count(&name, expected, values.len())?;
            for &value in values {
                check_number(&name, value, low..=LARGEST)?;
            }
        }
        Ok(())
    }
}

/// Mean and standard deviation from the sums of the powers 0, 1 and 2 of a feature.
fn mean_and_scale([count, first, second]: [f64; 3]) -> (f64, f64) {
    let count = f64::max(count, 1.0);
    let mean = first / count;
    let scale = (second / count - mean * mean).max(0.0).sqrt();
    // Rounding errors are not a scale.
    let least = 1e-9 * (1.0 + mean.abs());
    (mean, if scale > least { scale } else { 0.0 })
}
