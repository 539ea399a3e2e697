//! Metrics of answers, with bootstrap intervals.

use super::data::{DataSet, Fold, Truth, fold_of_group};
use super::definition::{Definition, ErrorMetric, Split, Target};
use super::entries::{Answers, Predictions};
use feeler_lab::grasps::{Labelled, score_at, score_in_folds};
use feeler_lab::sweep::analysis::{Estimate, bootstrap_of};
use std::collections::{BTreeMap, HashMap};

/// Minimum number of tested groups that are resampled as a whole; otherwise contiguous parts of recordings are.
const MIN_GROUPS: usize = 5;
/// Number of parts into which all tested recordings are divided, if parts are resampled.
const PARTS: usize = 20;

/// Lower end, estimate and upper end of a metric; `None` if undetermined.
pub type Metric = Option<[f64; 3]>;

/// Returns the names of the metrics of a data set, with their units.
pub fn metric_names(definition: &Definition) -> Vec<(String, String)> {
    match (&definition.slip, &definition.values) {
        (Some(slip), _) => {
            let accuracy = slip
                .accuracy
                .then(|| ("accuracy".to_owned(), String::new()));
            accuracy
                .into_iter()
                .chain([("auc".to_owned(), String::new())])
                .collect()
        }
        (_, Some(values)) => {
            let named = |target: &Target| {
                (
                    format!("{} {}", values.metric.name(), target.name),
                    target.unit.clone(),
                )
            };
            values.targets.iter().map(named).collect()
        }
        _ => Vec::new(),
    }
}

/// Computes the metrics of `answers`, in the order of [`metric_names`].
pub fn metrics(
    definition: &Definition,
    set: &DataSet,
    folds: &[Fold],
    answers: &Answers,
) -> Vec<Metric> {
    match (&definition.slip, &definition.values) {
        (Some(slip), _) => {
            let [accuracy, auc] = slip_metrics(definition.split, set, folds, answers);
            match slip.accuracy {
                true => vec![accuracy, auc],
                false => vec![auc],
            }
        }
        (_, Some(values)) => match answers {
            Answers::Rows(rows) => errors(values.metric, values.targets.len(), set, folds, rows),
            Answers::Scores(_) => vec![None; values.targets.len()],
        },
        _ => Vec::new(),
    }
}

/// Computes the accuracy and the area under the ROC curve.
fn slip_metrics(split: Split, set: &DataSet, folds: &[Fold], answers: &Answers) -> [Metric; 2] {
    let (scores, is_probability) = match answers {
        Answers::Scores(scores) => (scores.clone(), false),
        Answers::Rows(rows) => (answered(set, folds, rows), true),
    };
    let labelled = set.slips.iter().zip(&scores).map(|(slip, score)| Labelled {
        group: set.recordings[slip.recording].group,
        slip: slip.slip,
        // Without a score, no slip is reported.
        score: Some(score.unwrap_or(f64::MIN)),
    });
    let labelled: Vec<_> = labelled.collect();
    let groups = set.groups.len();
    let outcome = match split {
        _ if is_probability => score_at(&labelled, 0.5),
        Split::Group { folds } => {
            score_in_folds(&labelled, |group| fold_of_group(group, folds, groups))
        }
        _ => score_in_folds(&labelled, |group| group),
    };
    let ends = |estimate: Option<Estimate>| estimate.map(|e| e.with_ends(groups));
    [ends(outcome.accuracy), ends(outcome.auc)]
}

/// Returns the answer of a program for each labelled recording or row.
fn answered(set: &DataSet, folds: &[Fold], rows: &[Predictions]) -> Vec<Option<f64>> {
    let mut by_recording: HashMap<usize, &Vec<Vec<f64>>> = HashMap::new();
    for (fold, predictions) in folds.iter().zip(rows) {
        for (piece, predicted) in fold.test.iter().zip(predictions) {
            by_recording.insert(piece.recording, predicted);
        }
    }
    let score = |slip: &super::data::Slip| {
        let predicted = by_recording.get(&slip.recording)?;
        predicted.get(slip.row.unwrap_or(0))?.first().copied()
    };
    set.slips.iter().map(score).collect()
}

/// Sum of the errors of one target, and their number.
#[derive(Debug, Clone, Copy, Default)]
struct Sum(f64, f64);

/// Computes the error of each target.
fn errors(
    metric: ErrorMetric,
    targets: usize,
    set: &DataSet,
    folds: &[Fold],
    predictions: &[Predictions],
) -> Vec<Metric> {
    let tested = folds.iter().flat_map(|fold| &fold.test);
    let pieces = tested.clone().count();
    let mut groups: Vec<_> = tested
        .map(|piece| set.recordings[piece.recording].group)
        .collect();
    groups.sort_unstable();
    groups.dedup();
    let parts = PARTS.div_ceil(pieces.max(1));
    // Rows are resampled together if they have the same key: group, or piece and part.
    let key = |group: usize, piece: usize, row: usize, rows: usize| match groups.len() >= MIN_GROUPS
    {
        true => (group, 0),
        false => (piece, row * parts / rows.max(1)),
    };
    let of_target = |target: usize| {
        let mut sums: BTreeMap<(usize, usize), Sum> = BTreeMap::new();
        let all = folds
            .iter()
            .zip(predictions)
            .flat_map(|(f, p)| f.test.iter().zip(p));
        for (number, (piece, predicted)) in all.enumerate() {
            let recording = &set.recordings[piece.recording];
            let Truth::Values(truth) = &recording.truth else {
                continue;
            };
            let rows = truth[piece.rows.clone()].iter().zip(predicted).enumerate();
            for (row, (truth, predicted)) in rows {
                let error = predicted[target] - truth[target];
                if truth[target].is_finite() {
                    let sum = sums
                        .entry(key(recording.group, number, row, piece.rows.len()))
                        .or_default();
                    let size = match metric {
                        ErrorMetric::Rmse => error * error,
                        ErrorMetric::Mae => error.abs(),
                    };
                    (sum.0, sum.1) = (sum.0 + size, sum.1 + 1.0);
                }
            }
        }
        let sums: Vec<_> = sums.into_values().collect();
        let error = |drawn: &[&Sum]| {
            let (sum, count) = drawn
                .iter()
                .fold((0.0, 0.0), |(a, b), s| (a + s.0, b + s.1));
            match metric {
                ErrorMetric::Rmse => (sum / count).sqrt(),
                ErrorMetric::Mae => sum / count,
            }
        };
        bootstrap_of(&sums, error).map(|estimate| estimate.with_ends(sums.len()))
    };
    (0..targets).map(of_target).collect()
}
