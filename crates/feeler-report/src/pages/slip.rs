//! `slip.html`: slip detectors compared with ground truth, on a self-contained page.

use super::document::{Tile, document_of_figures, figures, number_heads, numbers, table, tiles};
use super::text::{share, significant};
use crate::figures::Figure;
use crate::figures::slip::{Mark, Roc, roc_figure};
use maud::html;
use serde::Serialize;

/// Lower end of the false alarm axis (%). Precise detectors are far below one percent.
const LEAST: f64 = 0.01;

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

impl SlipPage {
    /// Detection rate against false alarm rate of each detector, with its operating points.
    fn figure(&self, number: u32) -> Figure {
        let curves: Vec<_> = self.curves.iter().enumerate().collect();
        let marks: Vec<_> = self.points.iter().filter_map(|p| self.mark(p)).collect();
        let caption = "Curves are over all thresholds. Dots are the experiment's threshold and the chosen thresholds, with the 95 % interval of the detection rate.";
        roc_figure(&curves, &marks, LEAST, caption, number)
    }

    /// Dot of an operating point, if it and the detector's curve are known.
    fn mark(&self, point: &OperatingPoint) -> Option<Mark> {
        let [low, recall, high] = point.recall?;
        let mut curves = self.curves.iter();
        Some(Mark {
            name: format!("{} above {}", point.name, significant(point.threshold)),
            detector: curves.position(|curve| curve.name == point.name)?,
            at: (point.false_alarms?[1], recall),
            interval: Some((low, high)),
            label: Some(format!("precision {} %", share(point.precision))),
        })
    }
}

impl OperatingPoint {
    /// Formatted values in the order of [`COLUMNS`].
    pub fn fields(&self) -> [String; 6] {
        let delay = self.median_delay.map(|frames| frames.to_string());
        let (never, of) = self.never_noticed;
        [
            format!("{:.4}", self.threshold),
            share(self.precision),
            share(self.recall),
            share(self.false_alarms),
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
    let drawn = [page.figure(1)];
    let rows = page.points.iter();
    let rows = rows.map(|point| html! { td { (point.name) } (numbers(point.fields())) });
    let body = html! {
        h1 { "Slip detectors: " (page.name) }
        (tiles(&tiles_of(page)))
        p {
            (page.trials) " trials with seed " (page.seed) ": random presses, drags, twists and holds on stationary flat, round and cylindrical "
            "specimens with friction 0.3 to 1.2 and rubber within 10 % of its nominal stiffness. An element is scored in every "
            "frame at whose start its force exceeds " (page.touch_force) " N: " (samples) " element-frames, " (slips)
            " of them slips according to ground truth. Thresholds were chosen on an equal number of other trials."
        }
        (figures(&drawn))
        (table(html! { th { "Detector" } (number_heads(COLUMNS)) }, rows))
        p.note {
            "Brackets show 95 % confidence intervals (bootstrap over trials)."
            @if page.trials == 1 { " A single trial has no interval." }
            " Thresholds are in N/s for the shear rate and in N for missing shear. "
            "If the object may move, shear that is missing on all touching elements alike counts as motion of the object. "
            "A slip begins after five frames without slip and counts as never detected after ten frames."
        }
    };
    let title = format!("Slip detectors: {}", page.name);
    document_of_figures(&title, body, &drawn)
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
