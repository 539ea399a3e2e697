//! Regression features of a taxel array.

use super::memory::{TIME_CONSTANTS, TaxelInput};
use crate::sensor::wrench::WrenchError;
use crate::sensor::wrench::basis::{Basis, MAX_FEATURE, mean_and_scale, zero_if_nan};
use crate::sensor::wrench::calibration::{LARGEST, check_count, check_number};
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Kind of regression terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TermKind {
    /// All readings.
    Linear,
    /// The readings and the products of all pairs.
    Quadratic,
    /// Direction of the vector of all readings, logarithm of its length, and the products of all pairs of these.
    Pattern,
}

/// Regression terms of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelTerms {
    /// Kind of terms that are computed from the readings.
    pub kind: TermKind,
    /// `true` to also use the differences between the readings and their low-pass filters.
    pub memory: bool,
}

/// Mean and standard deviation of features over the samples of a calibration.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statistics {
    /// Mean of each feature.
    pub mean: Vec<f64>,
    /// Standard deviation of each feature; 0 for constant features, which are not used.
    pub scale: Vec<f64>,
}

/// Statistics of a taxel array's features, computed from the vector v of the readings of all taxels.
///
/// A feature is missing (NaN) if it depends on a missing taxel. The length |v| excludes missing taxels, so the
/// direction v/|v| is exact only if all taxels are valid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelBasis {
    /// Number of taxels.
    pub taxels: usize,
    /// Lower bound of |v|, N or counts: a tenth of its root mean square over the samples. Its square is added to |v|²,
    /// so that noise does not determine the direction of weak readings.
    pub norm_floor: f64,
    /// Matrix for each taxel that converts its reading to that of the original sensor, if the calibration was
    /// transferred to this copy; otherwise empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub to_original: Vec<DMat3>,
    /// Statistics of the features in this order: readings x, y and z of each taxel; their products; their direction and
    /// ln |v|; products of these; differences from the filters of each taxel and component, filter by filter.
    pub features: Statistics,
}

/// Ratio of [`TaxelBasis::norm_floor`] to the root mean square length.
const NORM_FLOOR: f64 = 0.1;
/// Standard deviation of the memory terms relative to that of the others. Hysteresis is a small part of a reading, and
/// ridge regression penalises the weights of smaller terms more.
const MEMORY_SCALE: f64 = 0.1;
/// Magnitude at which a product saturates, in standard deviations. Products model curvature within the calibrated
/// range; beyond it they would diverge.
const MAX_PRODUCT: f64 = 16.0;
/// Maximum number of taxels for which pattern and product terms are used.
const MAX_FOR_PRODUCTS: usize = 10;

/// Terms used for novelty detection.
const NOVELTY: TaxelTerms = TaxelTerms {
    kind: TermKind::Linear,
    memory: false,
};

/// Index ranges of the groups of features.
struct Groups {
    /// Readings x, y and z of each taxel.
    readings: Range<usize>,
    /// Products of all pairs of readings.
    products: Range<usize>,
    /// Direction of the vector of all readings, and ln |v|.
    pattern: Range<usize>,
    /// Products of all pairs of the pattern features.
    pattern_products: Range<usize>,
    /// Differences between the readings and their low-pass filters, filter by filter.
    memory: Range<usize>,
}

impl Groups {
    /// Returns the ranges for `taxels` taxels. If there are more than [`MAX_FOR_PRODUCTS`], pattern and products are
    /// empty.
    fn of(taxels: usize) -> Self {
        let readings = 3 * taxels;
        let pairs = |count: usize| count * (count + 1) / 2;
        let counts = match taxels <= MAX_FOR_PRODUCTS {
            true => [pairs(readings), readings + 1, pairs(readings + 1)],
            false => [0; 3],
        };
        let mut end = 0;
        let mut next = |count: usize| {
            let start = end;
            end += count;
            start..end
        };
        Self {
            readings: next(readings),
            products: next(counts[0]),
            pattern: next(counts[1]),
            pattern_products: next(counts[2]),
            memory: next(readings * TIME_CONSTANTS.len()),
        }
    }
}

impl TaxelBasis {
    /// Readings of all taxels, converted to those of the original sensor.
    fn readings<'a>(&'a self, input: &'a TaxelInput) -> impl Iterator<Item = DVec3> + Clone + 'a {
        let values = input.values.iter().enumerate();
        values.map(|(taxel, value)| self.as_original(taxel, *value))
    }

    fn as_original(&self, taxel: usize, value: DVec3) -> DVec3 {
        match self.to_original.get(taxel) {
            Some(map) => *map * value,
            None => value,
        }
    }

    /// Fills `features` with the features of `input` before standardisation. Missing and excess taxels are ignored.
    fn raw(&self, input: &TaxelInput, features: &mut [f64]) {
        let groups = Groups::of(self.taxels);
        features.fill(f64::NAN);
        let flat = |vectors: &mut dyn Iterator<Item = DVec3>, features: &mut [f64]| {
            for (vector, features) in vectors.zip(features.chunks_exact_mut(3)) {
                features.copy_from_slice(&vector.to_array());
            }
        };
        let values = self.readings(input);
        flat(
            &mut { values.clone() },
            &mut features[groups.readings.clone()],
        );
        for (constant, features) in (features[groups.memory.clone()])
            .chunks_exact_mut(groups.readings.len().max(1))
            .enumerate()
        {
            let pairs = values.clone().zip(&input.filtered);
            flat(
                &mut pairs.enumerate().map(|(taxel, (value, filtered))| {
                    value - self.as_original(taxel, filtered[constant])
                }),
                features,
            );
        }
        let Some(length) = features[groups.pattern.clone()].last_mut() else {
            return;
        };
        let norm = (squared_length(values.clone()) + self.norm_floor * self.norm_floor).sqrt();
        *length = libm::log(norm);
        flat(
            &mut values.map(|value| value / norm),
            &mut features[groups.pattern.clone()],
        );
        fill_products(features, &groups.readings, &groups.products);
        fill_products(features, &groups.pattern, &groups.pattern_products);
    }
}

/// Squared length |v|² of the vector of all readings, without missing ones.
fn squared_length(values: impl Iterator<Item = DVec3>) -> f64 {
    let valid = values.filter(|value| !value.is_nan());
    valid.map(DVec3::length_squared).sum()
}

/// Fills the range `products` of `features` with the products of all pairs of features in the range `factors`.
fn fill_products(features: &mut [f64], factors: &Range<usize>, products: &Range<usize>) {
    let pairs = factors
        .clone()
        .flat_map(|first| (first..factors.end).map(move |second| (first, second)));
    for ((first, second), product) in pairs.zip(products.clone()) {
        features[product] = features[first] * features[second];
    }
}

impl Basis for TaxelBasis {
    const KIND: &'static str = "taxel_wrench";
    const MAX_ROWS: usize = 1000;
    type Input = TaxelInput;
    type Terms = TaxelTerms;

    fn elements_of(input: &TaxelInput) -> usize {
        input.values.len()
    }

    fn from_inputs(elements: usize, inputs: &[&TaxelInput]) -> Self {
        let squares = inputs
            .iter()
            .map(|input| squared_length(input.values.iter().copied()));
        let squares: f64 = squares.sum();
        // Not 0, by which directions would be divided.
        let norm_floor = NORM_FLOOR * (squares / inputs.len().max(1) as f64).sqrt();
        let norm_floor = norm_floor.max(f64::MIN_POSITIVE.sqrt());
        let mut basis = Self {
            taxels: elements,
            norm_floor,
            to_original: Vec::new(),
            features: Statistics::default(),
        };
        let mut features = vec![0.0; basis.feature_count()];
        let mut sums = vec![[0.0; 3]; features.len()];
        for input in inputs {
            basis.raw(input, &mut features);
            let valid = sums.iter_mut().zip(&features);
            for (sums, &value) in valid.filter(|(_, value)| !value.is_nan()) {
                for (sum, power) in sums.iter_mut().zip([1.0, value, value * value]) {
                    *sum += power;
                }
            }
        }
        let (mean, scale) = sums.into_iter().map(mean_and_scale).unzip();
        basis.features = Statistics { mean, scale };
        basis
    }

    fn missing_input(&self) -> TaxelInput {
        TaxelInput {
            values: vec![DVec3::NAN; self.taxels],
            filtered: vec![[DVec3::ZERO; TIME_CONSTANTS.len()]; self.taxels],
        }
    }

    fn feature_count(&self) -> usize {
        Groups::of(self.taxels).memory.end
    }

    fn standardise(&self, input: &TaxelInput, features: &mut [f64]) -> f64 {
        self.raw(input, features);
        let Statistics { mean, scale } = &self.features;
        for ((feature, mean), &scale) in features.iter_mut().zip(mean).zip(scale) {
            *feature = match scale > 0.0 {
                true => ((*feature - mean) / scale).clamp(-MAX_FEATURE, MAX_FEATURE),
                false => 0.0,
            };
        }
        let missing = input.values.iter().filter(|value| value.is_nan()).count();
        missing as f64 / input.values.len().max(1) as f64
    }

    /// Readings below the noise floor are those of a skin without contact.
    fn reveals_place(&self, input: &TaxelInput) -> bool {
        squared_length(self.readings(input)) >= self.norm_floor * self.norm_floor
    }

    fn candidates(&self) -> Vec<TaxelTerms> {
        let kinds: &[TermKind] = match self.taxels <= MAX_FOR_PRODUCTS {
            true => &[TermKind::Linear, TermKind::Quadratic, TermKind::Pattern],
            false => &[TermKind::Linear],
        };
        // Constant memory would be chosen for rounding errors.
        let scales = &self.features.scale[Groups::of(self.taxels).memory];
        let memory: &[bool] = match scales.iter().any(|&scale| scale > 0.0) {
            true => &[false, true],
            false => &[false],
        };
        let terms = |&kind| {
            memory
                .iter()
                .map(move |&memory| TaxelTerms { kind, memory })
        };
        kinds.iter().flat_map(terms).collect()
    }

    fn novelty_terms(&self, _: &[TaxelTerms]) -> TaxelTerms {
        NOVELTY
    }

    fn supports_novelty(terms: TaxelTerms) -> bool {
        terms == NOVELTY
    }

    fn describe(terms: TaxelTerms) -> String {
        let kind = match terms.kind {
            TermKind::Linear => "readings",
            TermKind::Quadratic => "readings and their products",
            TermKind::Pattern => "direction and length of the readings, and their products",
        };
        let memory = if terms.memory { ", memory" } else { "" };
        format!("{kind}{memory}")
    }

    fn term_count(&self, terms: TaxelTerms) -> usize {
        let (linear, products, memory) = ranges(self.taxels, terms);
        linear.len() + products.len() + memory.len()
    }

    /// Order of the terms: readings or pattern, their products, memory.
    fn terms<'a>(
        &'a self,
        terms: TaxelTerms,
        features: &'a [f64],
    ) -> impl Iterator<Item = f64> + 'a {
        let (linear, products, memory) = ranges(self.taxels, terms);
        let of = |range: Range<usize>| features[range].iter().copied().map(zero_if_nan);
        let products = of(products).map(|p| p.clamp(-MAX_PRODUCT, MAX_PRODUCT));
        let memory = of(memory).map(|feature| MEMORY_SCALE * feature);
        of(linear).chain(products).chain(memory)
    }

    /// Nine per taxel, the entries of a 3 x 3 matrix, if products of readings are used; otherwise 0, because linear
    /// terms alone adapt to any such matrix.
    fn copy_parameters(&self) -> usize {
        match self.taxels <= MAX_FOR_PRODUCTS {
            true => 9 * self.taxels,
            false => 0,
        }
    }

    fn of_copy(&self, parameters: &[f64]) -> Self {
        let matrices = parameters.as_chunks::<9>().0.iter().enumerate();
        let to_original = matrices.map(|(taxel, change)| {
            let copy = DMat3::IDENTITY + DMat3::from_cols_array(change);
            self.to_original
                .get(taxel)
                .map_or(copy, |before| *before * copy)
        });
        Self {
            to_original: to_original.collect(),
            ..self.clone()
        }
    }

    fn check(&self, elements: usize) -> Result<(), WrenchError> {
        check_count("model.elements.taxels", elements, self.taxels)?;
        // Before numbers of features are computed, which would overflow.
        check_number("model.elements.taxels", self.taxels as f64, 1.0..=1e6)?;
        check_number(
            "model.elements.norm_floor",
            self.norm_floor,
            1e-200..=LARGEST,
        )?;
        if !self.to_original.is_empty() {
            let name = "model.elements.to_original";
            check_count(name, elements, self.to_original.len())?;
            for number in self.to_original.iter().flat_map(DMat3::to_cols_array) {
                check_number(name, number, -LARGEST..=LARGEST)?;
            }
        }
        let Statistics { mean, scale } = &self.features;
        let expected = Groups::of(elements).memory.end;
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

/// Index ranges of the features that are used as `terms`: readings or pattern, their products, memory.
fn ranges(taxels: usize, terms: TaxelTerms) -> (Range<usize>, Range<usize>, Range<usize>) {
    let groups = Groups::of(taxels);
    let (linear, products) = match terms.kind {
        TermKind::Linear => (groups.readings, 0..0),
        TermKind::Quadratic => (groups.readings, groups.products),
        TermKind::Pattern => (groups.pattern, groups.pattern_products),
    };
    let memory = if terms.memory { groups.memory } else { 0..0 };
    (linear, products, memory)
}
