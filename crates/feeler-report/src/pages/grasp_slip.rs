//! `slip.html` of recordings: slip detectors evaluated on labelled grasps, on a self-contained page.

use super::document::{Tile, document_of_figures, figures, number_heads, numbers, table, tiles};
use super::text::{share, significant, with_interval};
use crate::figures::Figure;
use crate::figures::slip::{Mark, Roc, roc_figure};
use maud::{Markup, html};
use serde::Serialize;

/// Content of the slip detector page for recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspSlipPage {
    /// Name of the set of recordings.
    pub name: String,
    /// Labeled units: `recordings` or `frames`.
    pub of: &'static str,
    /// Grouping for cross-validation: a column of the labels, or `recording`.
    pub grouped_by: String,
    /// Number of labelled units, of slips among them, and of groups.
    pub counts: (usize, usize, usize),
    /// Results of the detectors.
    pub detectors: Vec<GraspDetector>,
    /// Other recordings used to choose thresholds, if any: name, number of units, number of slips.
    pub others: Option<(String, usize, usize)>,
    /// Notes on unusual or unlabelled data.
    pub notes: Vec<String>,
}

/// Result of a detector. Estimates are `[low, estimate, high]` with the 95 % confidence interval, whose ends are NaN if
/// there is only one group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspDetector {
    /// Name of the detector.
    pub name: &'static str,
    /// Meaning and unit of its score.
    pub meaning: String,
    /// Area under the ROC curve; `None` if all or no units are slips, or if the detector has no scores.
    pub auc: Option<[f64; 3]>,
    /// Fraction of units (0 to 1) classified correctly, each group with the threshold chosen on all other groups.
    pub accuracy: Option<[f64; 3]>,
    /// Threshold chosen on all groups; `None` if the detector has no scores.
    pub threshold: Option<f64>,
    /// Detected slips, missed slips, false alarms and correct rejections.
    pub confusion: [usize; 4],
    /// Number of labelled units (recordings or frames) to which the detector gives no score.
    pub unknown: usize,
    /// Probabilities of slip from the scores; `None` if they cannot be cross-validated.
    pub probability: Option<GraspProbability>,
    /// Time of its alarms relative to the onset of slips, with thresholds chosen on all other groups; `None` if no onset
    /// is known.
    pub timing: Option<GraspTiming>,
    /// ROC curve.
    #[serde(skip)]
    pub curve: Roc,
    /// Misclassified recordings, with their number of misclassified frames if frames are labelled.
    pub wrong: Vec<String>,
    /// Result with thresholds from other recordings, if scores are comparable between the sets.
    pub transfer: Option<GraspTransfer>,
}

/// Probabilities of slip, 1 / (1 + exp(-(w0 + w1 score))), from the scores of a detector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspProbability {
    /// Weights `[w0, w1]`, fitted to all groups.
    pub weights: [f64; 2],
    /// Expected calibration error in ten intervals of probability, with weights fitted to all other groups.
    pub error: f64,
    /// Intervals: mean predicted probability, observed fraction of slips, number of units.
    pub bins: Vec<(f64, f64, usize)>,
}

/// Result of a detector with thresholds from other recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspTransfer {
    /// Threshold chosen on the other recordings only.
    pub threshold: f64,
    /// Fraction classified correctly with this threshold.
    pub alone: Option<[f64; 3]>,
    /// Detected slips, missed slips, false alarms and correct rejections with this threshold.
    pub confusion: [usize; 4],
    /// Fraction classified correctly with thresholds chosen on the other recordings and all other groups together.
    pub added: Option<[f64; 3]>,
}

/// Times at which a detector reports slips. Quartiles are the lower quartile, the median and the upper quartile (s).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspTiming {
    /// Number of slips with a known onset.
    pub slips: usize,
    /// Number of slips at whose onset an alarm was already active. They are not counted below.
    pub early: usize,
    /// Number of slips that are reported at or after their onset.
    pub reported: usize,
    /// Quartiles of the time from onset to alarm (s) of the reported slips.
    pub delay: Option<[f64; 3]>,
    /// Number of reported slips with a known time of loss.
    pub losses: usize,
    /// Number of slips with a known time of loss that are reported before the object is lost.
    pub before_loss: usize,
    /// Quartiles of the time from alarm to loss (s), negative if the alarm is later.
    pub lead: Option<[f64; 3]>,
}

/// Column headings of the times of alarms.
pub const TIMING_COLUMNS: [&str; 6] = [
    "onsets",
    "early",
    "reported",
    "delay (s)",
    "before loss",
    "lead time (s)",
];

impl GraspTiming {
    /// Formatted values in the order of [`TIMING_COLUMNS`].
    pub fn fields(&self) -> [String; 6] {
        let quartiles = |quartiles: Option<[f64; 3]>| match quartiles {
            Some(quartiles) => with_interval(quartiles, |value| format!("{value:.2}")),
            None => "-".into(),
        };
        [
            self.slips.to_string(),
            self.early.to_string(),
            self.reported.to_string(),
            quartiles(self.delay),
            format!("{} of {}", self.before_loss, self.losses),
            quartiles(self.lead),
        ]
    }
}

/// Column headings of a transfer result.
pub const TRANSFER_COLUMNS: [&str; 7] = [
    "transfer threshold",
    "transfer accuracy (%)",
    "transfer detected",
    "transfer missed",
    "transfer false alarms",
    "transfer rejections",
    "combined accuracy (%)",
];

impl GraspTransfer {
    /// Formatted values in the order of [`TRANSFER_COLUMNS`].
    pub fn fields(&self) -> [String; 7] {
        let [noticed, missed, alarms, quiet] = self.confusion.map(|count| count.to_string());
        let (alone, added) = (share(self.alone), share(self.added));
        let threshold = in_words(self.threshold);
        [threshold, alone, noticed, missed, alarms, quiet, added]
    }
}

/// Column headings of a detector's result.
pub const GRASP_COLUMNS: [&str; 11] = [
    "AUC",
    "accuracy (%)",
    "threshold",
    "slips detected",
    "slips missed",
    "false alarms",
    "correct rejections",
    "unknown",
    "calibration error",
    "log-odds of slip",
    "score",
];

impl GraspDetector {
    /// Formatted values in the order of [`GRASP_COLUMNS`].
    pub fn fields(&self) -> [String; 11] {
        let dash = || "-".to_string();
        let [noticed, missed, alarms, quiet] = self.confusion.map(|count| count.to_string());
        let known = self.probability.as_ref();
        [
            self.auc.map_or_else(dash, area),
            share(self.accuracy),
            self.threshold.map_or_else(dash, in_words),
            noticed,
            missed,
            alarms,
            quiet,
            self.unknown.to_string(),
            known.map_or_else(dash, |known| format!("{:.3}", known.error)),
            known.map_or_else(dash, log_odds),
            self.meaning.clone(),
        ]
    }
}

/// Formats the weights of probabilities.
fn log_odds(known: &GraspProbability) -> String {
    let [constant, slope] = known.weights;
    format!("{constant:.3} {slope:+.3} score")
}

/// Formats a threshold; infinite thresholds mean that the detector always or never fires.
fn in_words(threshold: f64) -> String {
    match threshold.is_finite() {
        true => significant(threshold),
        false if threshold < 0.0 => "always".into(),
        false => "never".into(),
    }
}

/// Formats an area with its interval, to three decimals.
fn area(area: [f64; 3]) -> String {
    with_interval(area, |value| format!("{value:.3}"))
}

/// Accuracy of the constant answer: the fraction of the more frequent class, given the number of units and of slips.
pub fn base_rate(all: usize, slips: usize) -> f64 {
    slips.max(all - slips) as f64 / all.max(1) as f64
}

/// Renders the page as HTML.
pub fn grasp_slip_page(page: &GraspSlipPage) -> String {
    let (all, slips, groups) = page.counts;
    let drawn = [roc(page, 1)];
    let base = significant(100.0 * base_rate(all, slips));
    let body = html! {
        h1 { "Slip detectors: " (page.name) }
        (tiles(&tiles_of(page)))
        p {
            (all) " labelled " (page.of) " in " (groups) " groups (" (page.grouped_by) "), " (slips) " of them slips. A constant answer has an "
            "accuracy of " (base) " %. Each threshold was chosen on all groups except the one it is tested on."
        }
        (figures(&drawn))
        (detectors_table(GRASP_COLUMNS, page.detectors.iter().map(|d| (d, d.fields()))))
        p.note {
            "Brackets show 95 % confidence intervals (bootstrap over groups)."
            @if groups == 1 { " A single group has no interval." }
            @else if groups < 10 { " With only " (groups) " groups, the intervals are unreliable." }
            " The calibration error is the mean difference between predicted and observed fractions of slips in ten intervals of probability, "
            "with weights fitted to the other groups."
            " AUC is the area under the curve: the probability that a slip has a higher score than a non-slip. The threshold is chosen on all "
            "groups, for use on other recordings. Missing shear requires the fingertip's pose, which recordings do not contain. "
            "Contact loss indicates that the object is gone, drag that it moves in the grip; labels may mean either. No detector predicts slip."
        }
        @if let Some((name, all, slips)) = &page.others {
            h2 { "With thresholds of other recordings" }
            p {
                (name) ": " (all) " labelled " (page.of) ", " (slips) " of them slips. Results with the threshold chosen on these alone, "
                "and with thresholds chosen on these and all other groups, both sets weighted equally."
            }
            (detectors_table(TRANSFER_COLUMNS, page.detectors.iter().filter_map(|d| Some((d, d.transfer.as_ref()?.fields())))))
            p.note { "Only detectors whose scores are comparable between both sets." }
        }
        @if page.detectors.iter().any(|detector| detector.timing.is_some()) {
            h2 { "Time of detection" }
            (detectors_table(TIMING_COLUMNS, page.detectors.iter().filter_map(|d| Some((d, d.timing.as_ref()?.fields())))))
            p.note {
                "The delay is the time from the onset of slip to the alarm, the lead time that from the alarm to the loss of the object: medians, "
                "with quartiles in brackets. Early: an alarm that started before the onset was still active at it; these slips are not in the delay "
                "and lead time. Labels of frames give only the onset; images give both: the loss is the first image of the final state, the "
                "onset the end of the last rest before. Thresholds were chosen on all other groups."
            }
        }
        @for (detector, known) in page.detectors.iter().filter_map(|d| Some((d, d.probability.as_ref()?))) {
            details {
                summary { "Reliability of the probabilities of " (detector.name) }
                (reliability(known))
            }
        }
        @for detector in page.detectors.iter().filter(|detector| !detector.wrong.is_empty()) {
            details {
                summary { (detector.wrong.len()) " misclassified by " (detector.name) }
                ul { @for wrong in &detector.wrong { li { (wrong) } } }
            }
        }
        @if !page.notes.is_empty() {
            h2 { "Notes" }
            ul { @for note in &page.notes { li { (note) } } }
        }
    };
    let title = format!("Slip detectors: {}", page.name);
    document_of_figures(&title, body, &drawn)
}

/// Table with one row per detector.
fn detectors_table<'a, const N: usize>(
    columns: [&str; N],
    rows: impl Iterator<Item = (&'a GraspDetector, [String; N])>,
) -> Markup {
    let head = html! { th { "Detector" } (number_heads(columns)) };
    let rows = rows.map(|(detector, fields)| html! { td { (detector.name) } (numbers(fields)) });
    table(head, rows)
}

/// Predicted and observed fractions of slips.
fn reliability(known: &GraspProbability) -> Markup {
    let head = html! { (number_heads(["Predicted", "Observed", "Number"])) };
    let rows = known.bins.iter().map(|(predicted, observed, count)| {
        let fields = [
            format!("{predicted:.2}"),
            format!("{observed:.2}"),
            count.to_string(),
        ];
        html! { (numbers(fields)) }
    });
    table(head, rows)
}

/// Detection rate against false alarm rate of each detector, with its result at thresholds from other groups.
fn roc(page: &GraspSlipPage, number: u32) -> Figure {
    let known = page.detectors.iter().enumerate();
    let known = known.filter(|(_, detector)| !detector.curve.points.is_empty());
    let curves: Vec<_> = (known.clone())
        .map(|(index, detector)| (index, &detector.curve))
        .collect();
    let marks = known.filter_map(|(index, detector)| {
        Some(Mark {
            name: format!("{}, thresholds of other groups", detector.name),
            detector: index,
            at: judged(detector)?,
            interval: None,
            label: None,
        })
    });
    let marks: Vec<_> = marks.collect();
    let caption = "Curves are over all thresholds. Dots are results with thresholds chosen on all other groups.";
    roc_figure(&curves, &marks, 0.0, caption, number)
}

/// False alarm rate and detection rate; `None` if there are no slips or no non-slips.
fn judged(detector: &GraspDetector) -> Option<(f64, f64)> {
    let [noticed, missed, alarms, quiet] = detector.confusion;
    let share = |part: usize, rest: usize| {
        let whole = part + rest;
        (whole > 0).then(|| part as f64 / whole as f64)
    };
    Some((share(alarms, quiet)?, share(noticed, missed)?))
}

/// Key figures: accuracy of each detector.
fn tiles_of(page: &GraspSlipPage) -> Vec<Tile> {
    let known = page.detectors.iter().filter_map(|detector| {
        let [_, right, _] = detector.accuracy?;
        let auc = detector.auc.map(|[_, auc, _]| format!(", AUC {auc:.3}"));
        let label = format!("accuracy of {}{}", detector.name, auc.unwrap_or_default());
        Some(Tile::new(significant(100.0 * right), "%", label))
    });
    known.collect()
}
