//! `slip.html` of recordings: slip detectors against the labels of grasps, on one self-contained page.

use super::compare_page::number;
use super::document::{Tile, document, tiles};
use super::figures::slip::grasp_roc_figure;
use super::page_data::PageData;
use super::slip_page::Roc;
use super::text::significant;
use maud::html;
use serde::Serialize;

/// What the page shows.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspSlipPage {
    /// Name of the recordings.
    pub name: String,
    /// What is labelled: `recordings` or `frames`.
    pub of: &'static str,
    /// What is left out together: a column of the labels, or `recording`.
    pub grouped_by: String,
    /// How many are labelled, how many of them are slips, and in how many groups.
    pub counts: (usize, usize, usize),
    /// How each detector did.
    pub detectors: Vec<GraspDetector>,
    /// Other recordings from which thresholds were taken, if they were: their name, how many, and how many of them are slips.
    pub others: Option<(String, usize, usize)>,
    /// What was odd, and what nothing is said of.
    pub notes: Vec<String>,
}

/// How a detector did. Estimates stand between the ends of their 95 % confidence intervals, which are not numbers where one
/// group has no interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspDetector {
    /// The detector.
    pub name: &'static str,
    /// What its score is, with its unit.
    pub meaning: String,
    /// Area under its curve; none where all are slips, or none is, or it says nothing.
    pub auc: Option<[f64; 3]>,
    /// Share that it calls rightly, with thresholds of all other groups.
    pub accuracy: Option<[f64; 3]>,
    /// The threshold of all together; none where it says nothing.
    pub threshold: Option<f64>,
    /// Slips noticed, slips missed, false alarms, and rightly quiet.
    pub confusion: [usize; 4],
    /// How many it says nothing of.
    pub unknown: usize,
    /// It over all thresholds.
    #[serde(skip)]
    pub curve: Roc,
    /// Which recordings it called wrongly, with how many of their frames where frames are labelled.
    pub wrong: Vec<String>,
    /// How it does with what other recordings taught it, where its numbers mean the same there.
    pub transfer: Option<GraspTransfer>,
}

/// How a detector does with thresholds of other recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspTransfer {
    /// The threshold that they alone choose.
    pub threshold: f64,
    /// Share that is called rightly with it.
    pub alone: Option<[f64; 3]>,
    /// With it: slips noticed, slips missed, false alarms, and rightly quiet.
    pub confusion: [usize; 4],
    /// Share that is called rightly with thresholds of the other recordings and of all other groups together.
    pub added: Option<[f64; 3]>,
}

/// What is said of a transfer.
pub const TRANSFER_COLUMNS: [&str; 7] = [
    "threshold of others",
    "right with it (%)",
    "noticed with it",
    "missed with it",
    "alarms with it",
    "quiet with it",
    "right with both (%)",
];

impl GraspTransfer {
    /// Its figures in words, in the order of [`TRANSFER_COLUMNS`].
    pub fn fields(&self) -> [String; 7] {
        let [noticed, missed, alarms, quiet] = self.confusion.map(|count| count.to_string());
        let (alone, added) = (percent(self.alone), percent(self.added));
        let threshold = in_words(self.threshold);
        [threshold, alone, noticed, missed, alarms, quiet, added]
    }
}

/// What is said of a detector.
pub const GRASP_COLUMNS: [&str; 9] = [
    "AUC",
    "right (%)",
    "threshold",
    "slips noticed",
    "slips missed",
    "false alarms",
    "rightly quiet",
    "unknown",
    "score",
];

impl GraspDetector {
    /// Its figures in words, in the order of [`GRASP_COLUMNS`].
    pub fn fields(&self) -> [String; 9] {
        let dash = || "-".to_string();
        let [noticed, missed, alarms, quiet] = self.confusion.map(|count| count.to_string());
        [
            self.auc.map_or_else(dash, area),
            percent(self.accuracy),
            self.threshold.map_or_else(dash, in_words),
            noticed,
            missed,
            alarms,
            quiet,
            self.unknown.to_string(),
            self.meaning.clone(),
        ]
    }
}

/// A threshold, or what it says if it is infinite.
fn in_words(threshold: f64) -> String {
    match threshold.is_finite() {
        true => significant(threshold),
        false if threshold < 0.0 => "always".into(),
        false => "never".into(),
    }
}

/// A share with its interval, in percent.
fn percent(share: Option<[f64; 3]>) -> String {
    let percent = |share: [f64; 3]| number(share.map(|part| 100.0 * part));
    share.map_or_else(|| "-".into(), percent)
}

/// An area with its interval, to three decimals.
fn area([low, mean, high]: [f64; 3]) -> String {
    match low.is_nan() || high.is_nan() {
        true => format!("{mean:.3} (no interval)"),
        false => format!("{mean:.3} [{low:.3}, {high:.3}]"),
    }
}

/// Share of the more frequent answer among `all`, of which so many are slips: what one is right in who says always the same.
pub fn base_rate(all: usize, slips: usize) -> f64 {
    slips.max(all - slips) as f64 / all.max(1) as f64
}

/// The page, as HTML text.
pub fn grasp_slip_page(page: &GraspSlipPage) -> String {
    let (all, slips, groups) = page.counts;
    let roc = grasp_roc_figure(page, 1);
    let base = significant(100.0 * base_rate(all, slips));
    let body = html! {
        h1 { "Slip detectors: " (page.name) }
        (tiles(&tiles_of(page)))
        p {
            (all) " labelled " (page.of) " in " (groups) " groups (" (page.grouped_by) "), " (slips) " of them slips. Who always says "
            "the same is right in " (base) " %. Every threshold was chosen on all groups but the one that is judged with it."
        }
        div.figures { (roc.markup()) }
        div.scroll {
            table {
                thead { tr { th { "Detector" } @for column in GRASP_COLUMNS { th.number { (column) } } } }
                tbody {
                    @for detector in &page.detectors {
                        tr {
                            td { (detector.name) }
                            @for field in detector.fields() { td.number { (field) } }
                        }
                    }
                }
            }
        }
        p.note {
            "In brackets 95 % confidence, by drawing whole groups again (bootstrap)."
            @if groups == 1 { " One group has no interval." }
            @else if groups < 10 { " Of " (groups) " groups, intervals say little." }
            " AUC: the area under the curve, the chance that a slip has a higher score than what is none. The threshold is that of all "
            "together, for use on others. Missing shear needs the fingertip's pose, which recordings do not have. "
            "Contact loss says that the object is gone, drag that it moves in the grip: labels may mean either. No detector foretells."
        }
        @if let Some((name, all, slips)) = &page.others {
            h2 { "With thresholds of other recordings" }
            p {
                (name) ": " (all) " labelled " (page.of) ", " (slips) " of them slips. First with the threshold that these alone "
                "choose, then with thresholds that they and all other groups choose, where both sides count as much."
            }
            div.scroll {
                table {
                    thead { tr { th { "Detector" } @for column in TRANSFER_COLUMNS { th.number { (column) } } } }
                    tbody {
                        @for (detector, transfer) in transferred(page) {
                            tr {
                                td { (detector.name) }
                                @for field in transfer.fields() { td.number { (field) } }
                            }
                        }
                    }
                }
            }
            p.note { "Only detectors whose numbers mean the same on both sides." }
        }
        @for detector in page.detectors.iter().filter(|detector| !detector.wrong.is_empty()) {
            details {
                summary { (detector.wrong.len()) " wrong by " (detector.name) }
                ul { @for wrong in &detector.wrong { li { (wrong) } } }
            }
        }
        @if !page.notes.is_empty() {
            h2 { "What was odd" }
            ul { @for note in &page.notes { li { (note) } } }
        }
    };
    let title = format!("Slip detectors: {}", page.name);
    document(&title, body, &PageData::of_figures(&title, &[roc]))
}

/// Detectors that other recordings taught a threshold.
fn transferred(page: &GraspSlipPage) -> impl Iterator<Item = (&GraspDetector, &GraspTransfer)> {
    let detectors = page.detectors.iter();
    detectors.filter_map(|detector| Some((detector, detector.transfer.as_ref()?)))
}

/// What each detector is right in.
fn tiles_of(page: &GraspSlipPage) -> Vec<Tile> {
    let known = page.detectors.iter().filter_map(|detector| {
        let [_, right, _] = detector.accuracy?;
        let auc = detector.auc.map(|[_, auc, _]| format!(", AUC {auc:.3}"));
        let label = format!("right by {}{}", detector.name, auc.unwrap_or_default());
        Some(Tile::new(significant(100.0 * right), "%", label))
    });
    known.collect()
}
