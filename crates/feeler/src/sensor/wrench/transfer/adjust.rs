//! Fits a gain and an offset of each component, and a linear map from the readings of a copy of the sensor to those of
//! the original.
//!
//! Minimises the squared errors of all components together over the parameters of the map ([`Basis::of_copy`]) and a gain
//! and an offset of each component, with a penalty on their squares, by Gauss-Newton iterations.

use super::data::PressData;
use crate::sensor::wrench::basis::{Basis, standardised};
use crate::sensor::wrench::calibration::{AxisModel, CalibrationOf, WrenchModel};
use crate::sensor::wrench::choice::{Shrinkage, best_penalty};
use crate::sensor::wrench::ridge::{Spectrum, regress};
use nalgebra::{DMatrix, DVector};

/// Expected magnitude of a parameter of the map, relative to the readings.
const EXPECTED_PARAMETER: f64 = 0.1;
/// Expected relative change of a component's gain. It is larger than [`EXPECTED_PARAMETER`], because a common factor is
/// the most probable difference between copies of a sensor.
const EXPECTED_GAIN_CHANGE: f64 = 0.3;
/// Expected offset of a component, relative to its held-out error.
const EXPECTED_OFFSET: f64 = 10.0;
/// Number of Gauss-Newton iterations. The map is nearly linear.
const ITERATIONS: usize = 3;
/// Step size of numerical derivatives.
const STEP: f64 = 1e-4;

/// Maximum number of samples used for the fit, evenly spread.
const MAX_SAMPLES: usize = 600;

/// Adjusts the model of `source` to all samples except those of the press `held`. Returns it unchanged if the fit has
/// no solution.
pub(super) fn adjusted<B: Basis>(
    source: &CalibrationOf<B>,
    data: &PressData<B>,
    held: Option<usize>,
) -> WrenchModel<B> {
    let used = (0..data.samples.len()).filter(|&row| Some(data.press_of[row]) != held);
    let used: Vec<_> = used.collect();
    let step = used.len().div_ceil(MAX_SAMPLES).max(1);
    let samples: Vec<_> = used.into_iter().step_by(step).collect();
    let mut rows = Vec::new();
    for (place, &sample) in samples.iter().enumerate() {
        let wrench = &data.samples[sample].wrench;
        for (axis, original) in source.model.axes.iter().enumerate() {
            let measured = wrench[original.axis.index()];
            rows.extend(measured.map(|measured| Row {
                place,
                axis,
                measured,
            }));
        }
    }
    let errors = source.quality.iter().map(|quality| quality.blocks.rmse);
    let problem = Problem {
        source: &source.model,
        parameters: source.model.elements.copy_parameters(),
        data,
        samples,
        rows,
        scales: errors
            .map(|error| 1.0 / error.max(f64::MIN_POSITIVE))
            .collect(),
    };
    let mut model = source.model.clone();
    if let Some(changes) = problem.solve() {
        problem.apply(&changes, &mut model);
    }
    model
}

/// Measured value of a component in one sample.
struct Row {
    /// Index of the sample in [`Problem::samples`].
    place: usize,
    /// Index of the component in the source's model.
    axis: usize,
    measured: f64,
}

struct Problem<'a, B: Basis> {
    source: &'a WrenchModel<B>,
    /// Number of parameters of the linear map.
    parameters: usize,
    data: &'a PressData<'a, B>,
    /// Indices of the samples used.
    samples: Vec<usize>,
    rows: Vec<Row>,
    /// Weight of the errors of each component: the inverse of the component's error in the source calibration.
    scales: Vec<f64>,
}

impl<B: Basis> Problem<'_, B> {
    /// Solves for the changes relative to their expected magnitude: parameters, then gains, then offsets. `None` if
    /// there is no solution.
    fn solve(&self) -> Option<Vec<f64>> {
        let count = self.parameters + 2 * self.scales.len();
        let mut changes = vec![0.0; count];
        let mut penalty = None;
        for _ in 0..ITERATIONS {
            let predicted = self.predict(&changes);
            let derivatives = self.derivatives(&changes, &predicted);
            let measured = self
                .rows
                .iter()
                .map(|row| self.scales[row.axis] * row.measured);
            let errors = DVector::from_iterator(self.rows.len(), measured) - predicted;
            // Linear in all changes, not only in those of this iteration, so that the penalty applies to their sum.
            let target = errors + &derivatives * DVector::from_column_slice(&changes);
            let target: Vec<f64> = target.iter().copied().collect();
            let penalty = match penalty {
                Some(penalty) => penalty,
                None => {
                    let samples = self.rows.iter().map(|row| self.samples[row.place]);
                    let samples: Vec<_> = samples.collect();
                    let folds = [self.data.folds(&samples)];
                    let spectrum = Spectrum::new(derivatives.clone());
                    *penalty.insert(
                        best_penalty(&spectrum, &target, (), &folds, Shrinkage::Strong)?.penalty,
                    )
                }
            };
            (_, changes) = regress(derivatives, &target, penalty)?;
        }
        Some(changes)
    }

    /// Predictions for all rows, in units of the components' errors in the source calibration.
    fn predict(&self, changes: &[f64]) -> DVector<f64> {
        let mut model = self.source.clone();
        self.apply(changes, &mut model);
        let inputs = self
            .samples
            .iter()
            .map(|&sample| &self.data.samples[sample].seen);
        let features = standardised(&model.elements, inputs);
        let values = self.rows.iter().map(|row| {
            let value = model.axes[row.axis].value(&model.elements, &features[row.place]);
            self.scales[row.axis] * value
        });
        DVector::from_iterator(self.rows.len(), values)
    }

    /// Numerical derivatives of the predictions with respect to each change, at `changes`.
    fn derivatives(&self, changes: &[f64], predicted: &DVector<f64>) -> DMatrix<f64> {
        let columns: Vec<_> = (0..changes.len())
            .map(|index| {
                let mut changed = changes.to_vec();
                changed[index] += STEP;
                (self.predict(&changed) - predicted) / STEP
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Applies `changes` to the source's model.
    fn apply(&self, changes: &[f64], model: &mut WrenchModel<B>) {
        let (parameters, changes) = changes.split_at(self.parameters);
        let parameters: Vec<_> = parameters
            .iter()
            .map(|change| EXPECTED_PARAMETER * change)
            .collect();
        if !parameters.is_empty() {
            model.elements = self.source.elements.of_copy(&parameters);
        }
        let (gains, offsets) = changes.split_at(self.scales.len());
        for (index, axis) in model.axes.iter_mut().enumerate() {
            scale(axis, 1.0 + EXPECTED_GAIN_CHANGE * gains[index]);
            axis.intercept += EXPECTED_OFFSET * offsets[index] / self.scales[index];
        }
    }
}

/// Multiplies the predictions of a component by `factor`.
fn scale<T>(axis: &mut AxisModel<T>, factor: f64) {
    axis.intercept *= factor;
    axis.weights.iter_mut().for_each(|weight| *weight *= factor);
}
