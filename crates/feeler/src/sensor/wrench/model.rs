//! Regression of a wrench.

use super::WrenchAxis;
use super::basis::Basis;
use super::moments::Terms;
use super::novelty::Novelty;
use serde::{Deserialize, Serialize};

/// Regression model of one component.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisModel<T = Terms> {
    /// The component.
    pub axis: WrenchAxis,
    /// Terms used by the regression.
    pub terms: T,
    /// Ridge penalty on the squared weights; features have a variance of 1.
    pub penalty: f64,
    /// Prediction if all terms are 0 (N, N·m or m).
    pub intercept: f64,
    /// Weight of each term, in the order of [`Basis::terms`] (N, N·m or m).
    pub weights: Vec<f64>,
}

impl<T: Copy> AxisModel<T> {
    /// Predicts the component from standardised `features` (N, N·m or m). Neither allocates nor panics.
    pub fn value<B: Basis<Terms = T>>(&self, basis: &B, features: &[f64]) -> f64 {
        let terms = basis.terms(self.terms, features).zip(&self.weights);
        self.intercept + terms.map(|(term, weight)| term * weight).sum::<f64>()
    }
}

/// Model that predicts a wrench from the features of all elements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "")]
pub struct WrenchModel<B: Basis> {
    /// Regression model of each component, in the order of [`WrenchAxis::ALL`].
    pub axes: Vec<AxisModel<B::Terms>>,
    /// Distribution of the calibration's samples, to detect samples that differ from them.
    pub novelty: Novelty<B::Terms>,
    /// Reference and statistics of the sensor's elements.
    pub elements: B,
}
