//! Entries of the league: programs, detectors and calibrations that are scored.

mod order;
mod program;
mod protocol;
mod ridge;
mod wrench;

pub use program::{Predictions, end_programs};
pub use wrench::Inputs;

use super::data::{DataSet, Fold, Piece, Truth};
use super::definition::Target;
use feeler_lab::grasps::DETECTORS;
use std::time::Duration;

/// An entry of the league.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// Always the same answer: the more frequent label, or the mean of the training values.
    Constant,
    /// A slip detector of feeler: its index in `DETECTORS`.
    Detector(usize),
    /// Ridge regression on all values, with or without their products.
    Ridge {
        /// `true` if products are used.
        products: bool,
    },
    /// The wrench calibration of feeler.
    Wrench,
    /// A user's program.
    Program {
        /// Name in results.
        name: String,
        /// Command for the system's shell.
        command: String,
    },
}

impl Entry {
    /// Returns the built-in entries for data sets labelled with slip (`true`) or with measured values, followed by
    /// `programs`.
    pub fn all(slip: bool, programs: &[Self]) -> Vec<Self> {
        let mut entries = vec![Self::Constant];
        match slip {
            true => entries.extend((0..DETECTORS.len()).map(Self::Detector)),
            false => entries.extend([
                Self::Ridge { products: false },
                Self::Ridge { products: true },
                Self::Wrench,
            ]),
        }
        entries.extend_from_slice(programs);
        entries
    }

    /// Name in results.
    pub fn name(&self) -> &str {
        match self {
            Self::Constant => "constant answer",
            Self::Detector(index) => DETECTORS[*index].name(),
            Self::Ridge { products: false } => "ridge",
            Self::Ridge { products: true } => "quadratic ridge",
            Self::Wrench => "wrench calibration",
            Self::Program { name, .. } => name,
        }
    }

    /// Name in definitions and tables.
    pub fn key(&self) -> &str {
        match self {
            Self::Constant => "constant",
            Self::Detector(index) => DETECTORS[*index].key(),
            Self::Ridge { products: false } => "ridge",
            Self::Ridge { products: true } => "quadratic_ridge",
            Self::Wrench => "wrench",
            Self::Program { name, .. } => name,
        }
    }
}

/// Answers of an entry.
pub enum Answers {
    /// Predicted targets or slip of each row, for each fold and test piece.
    Rows(Vec<Predictions>),
    /// Scores of the labelled recordings or rows; a threshold is chosen later.
    Scores(Vec<Option<f64>>),
}

/// A data set prepared for the entries: data, folds and targets.
pub struct Task<'a> {
    pub name: &'a str,
    pub set: &'a DataSet,
    pub folds: &'a [Fold],
    pub targets: &'a [Target],
    /// Inputs of the wrench calibration; `None` for slip.
    pub inputs: Option<&'a Inputs>,
    /// Time limit of a program for all folds.
    pub limit: Duration,
}

impl Task<'_> {
    /// Runs an entry.
    ///
    /// # Errors
    /// If it gives no answer.
    pub fn run(&self, entry: &Entry) -> Result<Answers, String> {
        let rows = |predict: &dyn Fn(&Fold) -> Result<Predictions, String>| {
            let folds = self.folds.iter().map(predict);
            folds.collect::<Result<_, _>>().map(Answers::Rows)
        };
        match entry {
            Entry::Constant if self.targets.is_empty() => {
                Ok(Answers::Scores(vec![Some(0.0); self.set.slips.len()]))
            }
            Entry::Detector(index) => {
                let scores = self
                    .set
                    .slips
                    .iter()
                    .map(|slip| slip.scores.get(*index).copied()?);
                let scores: Vec<_> = scores.collect();
                match scores.iter().any(Option::is_some) {
                    true => Ok(Answers::Scores(scores)),
                    false => Err("gives no score".into()),
                }
            }
            Entry::Constant => rows(&|fold| {
                Ok(self.by_rows(fold, |_, targets, test| vec![mean(targets); test.len()]))
            }),
            Entry::Ridge { products } => rows(&|fold| {
                Ok(self.by_rows(fold, |train, targets, test| {
                    ridge::predict(train, targets, test, *products)
                }))
            }),
            Entry::Wrench => rows(&|fold| {
                let names: Vec<_> = self
                    .targets
                    .iter()
                    .map(|target| target.name.as_str())
                    .collect();
                let inputs = self.inputs.ok_or("requires measured values")?;
                let mut found = inputs
                    .predict(self.set, fold, &names)
                    .map_err(|e| e.to_string())?;
                // Components that the calibration leaves out are predicted by the mean.
                let (_, targets) = self.training(fold);
                let mean = mean(&targets);
                for row in found.iter_mut().flatten() {
                    let unknown = row
                        .iter_mut()
                        .zip(&mean)
                        .filter(|(value, _)| value.is_nan());
                    unknown.for_each(|(value, mean)| *value = *mean);
                }
                Ok(found)
            }),
            Entry::Program { command, .. } => {
                let ran = program::run(
                    command,
                    self.name,
                    self.set,
                    self.folds,
                    self.targets,
                    self.limit,
                );
                ran.map(Answers::Rows).map_err(|e| e.to_string())
            }
        }
    }

    /// Values and targets of all training rows.
    fn training(&self, fold: &Fold) -> (Vec<&[f64]>, Vec<&[f64]>) {
        let mut found = (Vec::new(), Vec::new());
        for Piece { recording, rows } in &fold.train {
            let recording = &self.set.recordings[*recording];
            if let Truth::Values(truth) = &recording.truth {
                let rows = rows.clone();
                found
                    .0
                    .extend(recording.rows[rows.clone()].iter().map(Vec::as_slice));
                found.1.extend(truth[rows].iter().map(Vec::as_slice));
            }
        }
        found
    }

    /// Predicts all test rows at once with a function of training rows, their targets, and test rows.
    fn by_rows(
        &self,
        fold: &Fold,
        predict: impl Fn(&[&[f64]], &[&[f64]], &[&[f64]]) -> Vec<Vec<f64>>,
    ) -> Predictions {
        let (train, targets) = self.training(fold);
        let test = fold.test.iter().flat_map(|Piece { recording, rows }| {
            self.set.recordings[*recording].rows[rows.clone()]
                .iter()
                .map(Vec::as_slice)
        });
        let mut found = predict(&train, &targets, &test.collect::<Vec<_>>()).into_iter();
        let piece = |piece: &Piece| found.by_ref().take(piece.rows.len()).collect();
        fold.test.iter().map(piece).collect()
    }
}

/// Mean of each target, ignoring unknown values.
fn mean(targets: &[&[f64]]) -> Vec<f64> {
    let count = targets.first().map_or(0, |targets| targets.len());
    let of_target = |target: usize| {
        let known = targets
            .iter()
            .map(|row| row[target])
            .filter(|value| value.is_finite());
        let (sum, rows) = known.fold((0.0, 0.0), |(sum, rows), value| (sum + value, rows + 1.0));
        sum / f64::max(rows, 1.0)
    };
    (0..count).map(of_target).collect()
}
