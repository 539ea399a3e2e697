//! Regression features of one kind of sensor.

use super::error::WrenchError;
use nalgebra::DMatrix;
use serde::{Serialize, de::DeserializeOwned};
use std::fmt::Debug;

/// Features of a sensor, standardised by their statistics over the samples of a calibration, and the terms of the
/// regression that are computed from them.
///
/// Implemented for cameras ([`MomentBasis`](super::features::MomentBasis)) and taxel arrays
/// ([`TaxelBasis`](super::taxels::TaxelBasis)).
pub trait Basis:
    Debug + Clone + PartialEq + Send + Sync + Serialize + DeserializeOwned + 'static
{
    /// Kind of the calibration file.
    const KIND: &'static str;
    /// Maximum number of samples used to choose terms and penalty, evenly spread. The regression uses all samples.
    const MAX_ROWS: usize;
    /// Measurement of all elements at one time.
    type Input: Debug + Clone + PartialEq + Send + Sync;
    /// Choice of regression terms.
    type Terms: Debug + Copy + PartialEq + Send + Sync + Serialize + DeserializeOwned;

    /// Number of elements in `input`.
    fn elements_of(input: &Self::Input) -> usize;

    /// Computes the statistics of `elements` elements over `inputs`.
    fn learn(elements: usize, inputs: &[&Self::Input]) -> Self;

    /// Creates an input whose elements are missing, with memory for all elements.
    fn missing_input(&self) -> Self::Input;

    /// Number of features of one input.
    fn feature_count(&self) -> usize;

    /// Fills `features` with the standardised features of `input`, NaN where missing. Returns the fraction of elements
    /// that are missing, or 1 if all are. Neither allocates nor panics.
    fn standardise(&self, input: &Self::Input, features: &mut [f64]) -> f64;

    /// Candidate terms in order of preference.
    fn candidates(&self) -> Vec<Self::Terms>;

    /// Returns `true` if `terms` should replace `other` only if its errors are far smaller.
    fn is_doubtful(_terms: Self::Terms, _other: Self::Terms) -> bool {
        false
    }

    /// Terms for novelty detection, given those `chosen` for the components.
    fn watched(&self, chosen: &[Self::Terms]) -> Self::Terms;

    /// Returns `true` if novelty detection may use `terms`.
    fn can_watch(terms: Self::Terms) -> bool;

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

    /// Checks the numbers of a calibration file for `elements` elements.
    ///
    /// # Errors
    /// If a number is out of range or a list has the wrong length.
    fn check(&self, elements: usize) -> Result<(), WrenchError>;
}

/// Design matrix with one row of `terms` for each of `rows`.
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
