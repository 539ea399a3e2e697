//! Regression features of one kind of sensor.

use super::error::WrenchError;
use nalgebra::DMatrix;
use serde::{Serialize, de::DeserializeOwned};
use std::fmt::Debug;

/// Maximum fraction of elements that may be missing in a measurement used for fitting or prediction.
pub const MAX_MISSING: f64 = 0.1;

/// Maximum magnitude of a standardised feature, which keeps predictions finite for any input.
pub(super) const MAX_FEATURE: f64 = 1e6;

/// Standardisation of a sensor's features by their statistics over the samples of a calibration, and computation of
/// regression terms from them.
///
/// Implemented for cameras ([`MomentBasis`](super::moments::MomentBasis)) and taxel arrays
/// ([`TaxelBasis`](super::taxels::TaxelBasis)).
pub trait Basis:
    Debug + Clone + PartialEq + Send + Sync + Serialize + DeserializeOwned + 'static
{
    /// Value of `kind` in the calibration file.
    const KIND: &'static str;
    /// Maximum number of samples, evenly spread, on which all candidate terms are compared. The final regression uses
    /// all samples.
    const MAX_ROWS: usize;
    /// Measurement of all elements at one time.
    type Input: Debug + Clone + PartialEq + Send + Sync;
    /// Set of regression terms.
    type Terms: Debug + Copy + PartialEq + Send + Sync + Serialize + DeserializeOwned;

    /// Number of elements in `input`.
    fn elements_of(input: &Self::Input) -> usize;

    /// Computes the statistics of the features of `elements` elements over `inputs`.
    fn from_inputs(elements: usize, inputs: &[&Self::Input]) -> Self;

    /// Creates an input in which all elements are missing, with memory for all of them.
    fn missing_input(&self) -> Self::Input;

    /// Number of features of one input.
    fn feature_count(&self) -> usize;

    /// Fills `features` with the standardised features of `input`; NaN if missing. Returns the fraction of elements
    /// that are missing. Neither allocates nor panics.
    fn standardise(&self, input: &Self::Input, features: &mut [f64]) -> f64;

    /// Returns `true` if the readings in `input` are strong enough to estimate the place of contact.
    fn reveals_place(&self, _input: &Self::Input) -> bool {
        true
    }

    /// Candidate sets of terms, in order of preference.
    fn candidates(&self) -> Vec<Self::Terms>;

    /// Returns `true` if `terms` is prone to overfitting compared with `other`, and should replace it only if its
    /// errors are far smaller.
    fn is_prone_to_overfitting(_terms: Self::Terms, _other: Self::Terms) -> bool {
        false
    }

    /// Terms used for novelty detection, given the terms `chosen` for the components.
    fn novelty_terms(&self, chosen: &[Self::Terms]) -> Self::Terms;

    /// Returns `true` if novelty detection may use `terms`.
    fn supports_novelty(terms: Self::Terms) -> bool;

    /// Describes `terms` for reports.
    fn describe(terms: Self::Terms) -> String;

    /// Number of `terms`.
    fn term_count(&self, terms: Self::Terms) -> usize;

    /// Returns the values of `terms` for standardised `features`; 0 for missing features. Neither allocates nor panics.
    fn terms<'a>(
        &'a self,
        terms: Self::Terms,
        features: &'a [f64],
    ) -> impl Iterator<Item = f64> + 'a;

    /// Removes statistics that are not needed for any of `terms`, which changes the number of features. The default
    /// does nothing.
    fn keep_only(&mut self, _terms: &[Self::Terms]) {}

    /// Number of parameters that describe how the readings of another copy of the sensor differ from those of the
    /// original; 0 if this is not modelled.
    fn copy_parameters(&self) -> usize {
        0
    }

    /// Returns the features of another copy of the sensor, whose readings differ from those of this one by
    /// `parameters`, which are relative to the readings. If all parameters are 0, the features are the same.
    #[must_use]
    fn of_copy(&self, _parameters: &[f64]) -> Self {
        self.clone()
    }

    /// Checks the numbers of a calibration file for `elements` elements.
    ///
    /// # Errors
    /// If a number is out of range or a list has the wrong length.
    fn check(&self, elements: usize) -> Result<(), WrenchError>;
}

/// Design matrix: one row for each index in `rows`, one column for each term.
pub(super) fn matrix<B: Basis>(
    basis: &B,
    features: &[Vec<f64>],
    rows: &[usize],
    terms: B::Terms,
) -> DMatrix<f64> {
    let values = rows
        .iter()
        .flat_map(|&row| basis.terms(terms, &features[row]));
    DMatrix::from_row_iterator(rows.len(), basis.term_count(terms), values)
}

/// Standardised features of all `inputs`.
pub(super) fn standardised<'a, B: Basis>(
    basis: &B,
    inputs: impl IntoIterator<Item = &'a B::Input>,
) -> Vec<Vec<f64>> {
    let features = inputs.into_iter().map(|input| {
        let mut features = vec![0.0; basis.feature_count()];
        basis.standardise(input, &mut features);
        features
    });
    features.collect()
}

/// Returns 0 for a missing feature (NaN), so that it has no effect.
pub(super) fn zero_if_nan(feature: f64) -> f64 {
    if feature.is_nan() { 0.0 } else { feature }
}

/// Mean and standard deviation of a feature, from the sums of its powers 0, 1 and 2.
pub(super) fn mean_and_scale([count, first, second]: [f64; 3]) -> (f64, f64) {
    let count = f64::max(count, 1.0);
    let mean = first / count;
    let scale = (second / count - mean * mean).max(0.0).sqrt();
    // Rounding errors are not a scale.
    let least = 1e-9 * (1.0 + mean.abs());
    (mean, if scale > least { scale } else { 0.0 })
}
