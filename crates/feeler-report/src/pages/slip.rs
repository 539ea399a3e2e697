//! `slip.html`: slip detectors compared with ground truth, on a self-contained page.

use super::compare::number;
use super::document::{Tile, document, tiles};
use super::text::significant;
use crate::figures::slip::roc_figure;
use crate::page_data::PageData;
use maud::html;
use serde::Serialize;

/// Content of the slip detector page.
#[derive(Debug, Clone, PartialEq)]
pub struct SlipPage {
    /// Name of the experiment.
    pub name: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Number of trials used to choose thresholds; equal to the number of trials used for scoring.
    pub trials: u64,
    /// Touch threshold F1 of the experiment (N); only elements with a larger force are scored.
    pub touch_force: f64,
    /// Number of scored element-frames, and number of slips among them.
    pub counts: (usize, usize),
    /// Results of the detectors.
    pub points: Vec<OperatingPoint>,
    /// ROC curves of the detectors.
    pub curves: Vec<Roc>,
}

/// Result of a detector at one threshold. Estimates are `[low, estimate, high]` with the 95 % confidence interval,
/// whose ends are NaN if there is only one trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// Name of the detector.
    pub name: &'static str,
    /// Threshold, in the unit of the score.
    pub threshold: f64,
    /// Fraction of detections that are true slips.
    pub precision: Option<[f64; 3]>,
    /// Fraction of true slips that are detected in the same frame.
    pub recall: Option<[f64; 3]>,
    /// Fraction of non-slips that are detected as slips.
    pub false_alarms: Option<[f64; 3]>,
    /// Median delay from the start of a slip to its detection (frames); `None` if most slips are never detected.
    pub median_delay: Option<u32>,
    /// Number of slips that are never detected, and total number of slips.
    pub never_noticed: (usize, usize),
}

/// Receiver operating characteristic of a detector.
#[derive(Debug, Clone, PartialEq)]
pub struct Roc {
    /// Name of the detector.
    pub name: &'static str,
    /// False alarm rate and detection rate at each threshold.
    pub points: Vec<(f64, f64)>,
}

impl SlipPage {
    /// Index of the curve of an operating point.
    pub fn curve_of(&self, point: &OperatingPoint) -> Option<usize> {
        self.curves
            .iter()
            .position(|curve| curve.name == point.name)
    }
}

impl OperatingPoint {
    /// Formatted values in the order of [`COLUMNS`].
    pub fn fields(&self) -> [String; 6] {
        let percent = |share: Option<[f64; 3]>| {
            share.map_or_else(|| "-".to_string(), |s| number(s.map(|part| 100.0 * part)))
        };
        let delay = self.median_delay.map(|frames| frames.to_string());
        let (never, of) = self.never_noticed;
        [
            format!("{:.4}", self.threshold),
            percent(self.precision),
            percent(self.recall),
            percent(self.false_alarms),
            delay.unwrap_or_else(|| "never".to_string()),
            format!("{never} of {of}"),
        ]
    }
}

/// Column headings of an operating point.
pub const COLUMNS: [&str; 6] = [
    "threshold",
    "precision (%)",
    "recall (%)",
    "false alarms (%)",
    "median delay (frames)",
    "never detected",
];

/// Renders the page as HTML.
pub fn slip_page(page: &SlipPage) -> String {
    let (samples, slips) = page.counts;
    let roc = roc_figure(page, 1);
    let body = html! {
        h1 { "Slip detectors: " (page.name) }
        (tiles(&tiles_of(page)))
        p {
            (page.trials) " trials with seed " (page.seed) ": random presses, drags, twists and holds on stationary flat, round and cylindrical "
            "specimens with friction 0.3 to 1.2 and rubber within 10 % of its nominal stiffness. An element is scored in every "
            "frame at whose start its force exceeds " (page.touch_force) " N: " (samples) " element-frames, " (slips)
            " of them slips according to ground truth. Thresholds were chosen on an equal number of other trials."
        }
        div.figures { (roc.markup()) }
        div.scroll {
            table {
                thead { tr { th { "Detector" } @for column in COLUMNS { th.number { (column) } } } }
                tbody {
                    @for point in &page.points {
                        tr { td { (point.name) } @for field in point.fields() { td.number { (field) } } }
                    }
                }
            }
        }
        p.note {
            "Brackets show 95 % confidence intervals (bootstrap over trials)."
            @if page.trials == 1 { " A single trial has no interval." }
            " Thresholds are in N/s for the shear rate and in N for missing shear. "
            "If the object may move, shear that is missing on all touching elements alike counts as motion of the object. "
            "A slip begins after five frames without slip and counts as never detected after ten frames."
        }
    };
    let title = format!("Slip detectors: {}", page.name);
    document(&title, body, &PageData::of_figures(&title, &[roc]))
}

/// Key figures: slips detected at each detector's chosen threshold.
fn tiles_of(page: &SlipPage) -> Vec<Tile> {
    let chosen = page.curves.iter().filter_map(|curve| {
        let point = page.points.iter().rfind(|point| point.name == curve.name)?;
        let percent = |share: [f64; 3]| significant(100.0 * share[1]);
        let right = percent(point.precision?);
        let label = format!("of slips detected by {}, precision {right} %", curve.name);
        Some(Tile::new(percent(point.recall?), "%", label))
    });
    chosen.collect()
}
