//! Entry: feeler's wrench calibration, fitted to the training rows.

use crate::league::data::{DataSet, Fold, Piece, Recording, Truth};
use feeler::sensor::fingertip::{CalibrationTarget, LengthUnit};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::moments::MomentBasis;
use feeler::sensor::wrench::taxels::{Memory, TaxelBasis, TaxelInput, TaxelSeries};
use feeler::sensor::wrench::{AXES, EstimatorOf, SampleOf, WrenchAxis, WrenchError, fit};
use glam::{DVec2, DVec3};

/// Assigns a wrench component to each of the targets `names`: the one of the same name, or else an unused one.
fn axes(names: &[&str]) -> Vec<WrenchAxis> {
    let same = |name: &str| WrenchAxis::ALL.into_iter().find(|axis| axis.name() == name);
    let mut free = WrenchAxis::ALL
        .into_iter()
        .filter(|axis| !names.contains(&axis.name()));
    let axes = names
        .iter()
        .filter_map(|name| same(name).or_else(|| free.next()));
    axes.collect()
}

/// Measurements of a data set in the form that a calibration requires.
pub enum Inputs {
    Taxels(Vec<Vec<TaxelInput>>),
    Images(Vec<Vec<Vec<Option<ElementMoments>>>>),
}

impl Inputs {
    /// Converts all rows of a data set.
    pub fn of(set: &DataSet) -> Self {
        let recordings = set.recordings.iter();
        match set.columns {
            ["x", "y", "z"] => Self::Taxels(recordings.map(taxel_inputs).collect()),
            columns => {
                let inputs = |recording: &Recording| {
                    recording
                        .rows
                        .iter()
                        .map(|row| moments(row, columns.len()))
                        .collect()
                };
                Self::Images(recordings.map(inputs).collect())
            }
        }
    }

    /// Predicts the targets `names` in the test rows of a fold; NaN if the calibration returns no value.
    ///
    /// # Errors
    /// If the calibration cannot be fitted.
    pub fn predict(
        &self,
        set: &DataSet,
        fold: &Fold,
        names: &[&str],
    ) -> Result<Vec<Vec<Vec<f64>>>, WrenchError> {
        match self {
            Self::Taxels(inputs) => predict::<TaxelBasis>(inputs, set, fold, names),
            Self::Images(inputs) => predict::<MomentBasis>(inputs, set, fold, names),
        }
    }
}

fn predict<B: Basis>(
    inputs: &[Vec<B::Input>],
    set: &DataSet,
    fold: &Fold,
    names: &[&str],
) -> Result<Vec<Vec<Vec<f64>>>, WrenchError>
where
    B::Input: Clone,
{
    let axes = axes(names);
    let samples: Vec<_> = fold
        .train
        .iter()
        .flat_map(|piece| samples::<B>(inputs, set, piece, &axes))
        .collect();
    let elements = samples
        .first()
        .map_or(0, |sample| B::elements_of(&sample.seen));
    let target = CalibrationTarget::layout("league", elements, LengthUnit::Pixel);
    let recordings: Vec<_> = set
        .recordings
        .iter()
        .map(|recording| recording.name.clone())
        .collect();
    let fitted = fit(target, &recordings, &samples, false)?;
    let mut estimator = EstimatorOf::new(fitted.calibration)?;
    let pieces = fold.test.iter().map(|piece| {
        let rows = inputs[piece.recording][piece.rows.clone()].iter();
        let of_row = |input: &B::Input| {
            let estimate = estimator.estimate_with(|own| own.clone_from(input));
            let values = axes
                .iter()
                .map(|axis| estimate.component(*axis).unwrap_or(f64::NAN));
            values.collect()
        };
        rows.map(of_row).collect()
    });
    Ok(pieces.collect())
}

/// Returns the samples of the rows of a piece in which any target was measured.
fn samples<B: Basis>(
    inputs: &[Vec<B::Input>],
    set: &DataSet,
    piece: &Piece,
    axes: &[WrenchAxis],
) -> Vec<SampleOf<B>>
where
    B::Input: Clone,
{
    let Truth::Values(truth) = &set.recordings[piece.recording].truth else {
        return Vec::new();
    };
    let rows = piece
        .rows
        .clone()
        .filter(|&row| truth[row].iter().any(|value| value.is_finite()));
    let sample = |row: usize| {
        let mut wrench = [None; AXES];
        for (axis, &value) in axes.iter().zip(&truth[row]) {
            wrench[axis.index()] = Some(value).filter(|value| value.is_finite());
        }
        SampleOf {
            recording: piece.recording,
            seen: inputs[piece.recording][row].clone(),
            wrench,
        }
    };
    rows.map(sample).collect()
}

/// Converts rows to taxel readings, filtered as the calibration requires.
fn taxel_inputs(recording: &Recording) -> Vec<TaxelInput> {
    let taxels = recording.rows.first().map_or(0, |row| row.len() / 3);
    let mut memory = Memory::new(taxels);
    let mut series = TaxelSeries {
        stamps: recording.times.clone(),
        ..TaxelSeries::default()
    };
    for (time, row) in recording.times.iter().zip(&recording.rows) {
        let (values, _) = row.as_chunks::<3>();
        let values: Vec<_> = values.iter().map(|&value| DVec3::from(value)).collect();
        let mut input = TaxelInput::default();
        memory.update(*time, &values, &mut input);
        series.inputs.push(input);
    }
    series.forget_if_sparse();
    series.inputs
}

/// Converts a row of displacements, or of gray values and centroids, to the moments of the elements.
fn moments(row: &[f64], columns: usize) -> Vec<Option<ElementMoments>> {
    let moments = row.chunks_exact(columns).map(|values| {
        let (integrated_gray, centroid) = match *values {
            [x, y] => (1.0, DVec2::new(x, y)),
            [gray, x, y] => (gray, DVec2::new(x, y)),
            _ => return None,
        };
        let is_known = integrated_gray.is_finite() && centroid.is_finite();
        is_known.then_some(ElementMoments {
            integrated_gray,
            centroid,
        })
    });
    moments.collect()
}
