//! Contents of a data set in a common form, and its split into training and test data.

use super::definition::Split;
use std::ops::Range;

/// Contents of a data set.
#[derive(Debug)]
pub struct DataSet {
    /// Names of the values of one element, such as x, y and z.
    pub columns: &'static [&'static str],
    /// Unit of the values.
    pub unit: String,
    /// The recordings.
    pub recordings: Vec<Recording>,
    /// Names of the groups, sorted.
    pub groups: Vec<String>,
    /// Scores of feeler's slip detectors for the labelled recordings or frames, in the order of `DETECTORS`, by
    /// recording and frame.
    pub slips: Vec<Slip>,
    /// Hash of the input files.
    pub digest: String,
    /// Notes on irregular data.
    pub notes: Vec<String>,
}

/// One recording.
#[derive(Debug)]
pub struct Recording {
    /// Name, for messages.
    pub name: String,
    /// Index of the group.
    pub group: usize,
    /// Time of each row (s).
    pub times: Vec<f64>,
    /// Values of all elements in each row; NaN if unknown.
    pub rows: Vec<Vec<f64>>,
    /// Labels or measured values.
    pub truth: Truth,
}

/// Labels or measured values of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Truth {
    /// Slip in the whole recording.
    Slip(bool),
    /// Slip in each row, if labelled.
    SlipRows(Vec<Option<bool>>),
    /// Values in each row; NaN if not measured.
    Values(Vec<Vec<f64>>),
}

/// A labelled recording or row, with the scores of feeler's detectors.
#[derive(Debug, Clone)]
pub struct Slip {
    /// Index of the recording.
    pub recording: usize,
    /// Row; `None` for a whole recording.
    pub row: Option<usize>,
    /// Label.
    pub slip: bool,
    /// Scores of the detectors.
    pub scores: Vec<Option<f64>>,
}

/// Contiguous rows of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Piece {
    /// Index of the recording.
    pub recording: usize,
    /// The rows.
    pub rows: Range<usize>,
}

/// Training and test data.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Fold {
    pub train: Vec<Piece>,
    pub test: Vec<Piece>,
}

/// Returns the fold in which group `group` is tested.
pub fn fold_of_group(group: usize, folds: usize, groups: usize) -> usize {
    group % folds.min(groups).max(1)
}

/// Splits recordings, given by group and number of rows, into folds.
pub fn split(split: Split, recordings: &[(usize, usize)], groups: usize) -> Vec<Fold> {
    let whole = |recording: usize| Piece {
        recording,
        rows: 0..recordings[recording].1,
    };
    let all = 0..recordings.len();
    let folds: Vec<Fold> = match split {
        Split::Group { folds } => {
            let count = folds.min(groups);
            let fold = |number: usize| {
                let is_tested = |&recording: &usize| {
                    fold_of_group(recordings[recording].0, folds, groups) == number
                };
                let (test, train): (Vec<_>, Vec<_>) = all.clone().partition(is_tested);
                Fold {
                    train: train.into_iter().map(whole).collect(),
                    test: test.into_iter().map(whole).collect(),
                }
            };
            (0..count).map(fold).collect()
        }
        Split::Last { part } => {
            let fold = |recording: usize| {
                let rows = recordings[recording].1;
                let first = ((1.0 - part) * rows as f64).round() as usize;
                let piece = |rows| vec![Piece { recording, rows }];
                Fold {
                    train: piece(0..first),
                    test: piece(first..rows),
                }
            };
            all.map(fold).collect()
        }
        Split::Blocks { folds } => {
            let fold = |number: usize| {
                let mut fold = Fold::default();
                for recording in all.clone() {
                    let rows = recordings[recording].1;
                    let bound = |block: usize| block * rows / folds;
                    let (start, end) = (bound(number), bound(number + 1));
                    let guard = (end - start) / 10;
                    let piece = |rows| Piece { recording, rows };
                    fold.train.push(piece(0..start.saturating_sub(guard)));
                    fold.train.push(piece((end + guard).min(rows)..rows));
                    fold.test.push(piece(start..end));
                }
                fold
            };
            (0..folds).map(fold).collect()
        }
    };
    let is_used = |piece: &Piece| !piece.rows.is_empty();
    let without_empty = folds.into_iter().map(|mut fold| {
        fold.train.retain(is_used);
        fold.test.retain(is_used);
        fold
    });
    let is_used = |fold: &Fold| !fold.train.is_empty() && !fold.test.is_empty();
    without_empty.filter(is_used).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No row is tested twice, and no tested row, its group or its neighbours are used for training.
        #[test]
        fn tested_rows_are_not_trained_on(
            recordings in proptest::collection::vec((0..4_usize, 0..40_usize), 1..8), folds in 2..7_usize, kind in 0..3
        ) {
            let by = match kind {
                0 => Split::Group { folds },
                1 => Split::Last { part: 0.3 },
                _ => Split::Blocks { folds },
            };
            let mut tested: Vec<Vec<u32>> = recordings.iter().map(|&(_, rows)| vec![0; rows]).collect();
            for fold in split(by, &recordings, 4) {
                for test in &fold.test {
                    test.rows.clone().for_each(|row| tested[test.recording][row] += 1);
                    for train in &fold.train {
                        let apart = train.rows.end <= test.rows.start || test.rows.end <= train.rows.start;
                        prop_assert!(train.recording != test.recording || apart);
                        let same_group = recordings[train.recording].0 == recordings[test.recording].0;
                        prop_assert!(kind != 0 || !same_group);
                    }
                }
            }
            prop_assert!(tested.iter().flatten().all(|&times| times <= 1));
        }
    }
}
