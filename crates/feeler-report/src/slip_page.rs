//! `slip.html`: slip detectors against the truth, on one self-contained page.

use super::compare_page::number;
use super::document::{Tile, document, tiles};
use super::figures::slip::roc_figure;
use super::page_data::PageData;
use super::text::significant;
use maud::html;
use serde::Serialize;

/// What the page shows.
#[derive(Debug, Clone, PartialEq)]
pub struct SlipPage {
    /// The experiment's name.
    pub name: String,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Trials that thresholds were chosen on, and as many others that were scored.
    pub trials: u64,
    /// F1 of the experiment, N: elements pressed harder count.
    pub touch_force: f64,
    /// Element-frames that were scored, and slips among them.
    pub counts: (usize, usize),
    /// How each detector did.
    pub points: Vec<OperatingPoint>,
    /// The detectors over all thresholds.
    pub curves: Vec<Roc>,
}

/// How a detector did with one threshold. Estimates stand between the ends of their 95 % confidence intervals, which are
/// not numbers where one trial has no interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// The detector.
    pub name: &'static str,
    /// Its threshold, in the unit of its score.
    pub threshold: f64,
    /// Share of true slips in what it called one.
    pub precision: Option<[f64; 3]>,
    /// Share of true slips that it noticed in their very frame.
    pub recall: Option<[f64; 3]>,
    /// Share of what did not slip that it called a slip.
    pub false_alarms: Option<[f64; 3]>,
    /// Frames from the beginning of a slip to its being noticed; none if most never were.
    pub median_delay: Option<u32>,
    /// Slips that were never noticed, of so many.
    pub never_noticed: (usize, usize),
}

/// A detector over all thresholds.
#[derive(Debug, Clone, PartialEq)]
pub struct Roc {
    /// The detector.
    pub name: &'static str,
    /// Share of false alarms, and of slips noticed.
    pub points: Vec<(f64, f64)>,
}

impl SlipPage {
    /// Which curve an operating point is on.
    pub fn curve_of(&self, point: &OperatingPoint) -> Option<usize> {
        self.curves
            .iter()
            .position(|curve| curve.name == point.name)
    }
}

impl OperatingPoint {
    /// Its figures in words, in the order of [`COLUMNS`].
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

/// What an operating point says.
pub const COLUMNS: [&str; 6] = [
    "threshold",
    "precision (%)",
    "recall (%)",
    "false alarms (%)",
    "median delay (frames)",
    "never noticed",
];

/// The page, as HTML text.
pub fn slip_page(page: &SlipPage) -> String {
    let (samples, slips) = page.counts;
    let roc = roc_figure(page, 1);
    let body = html! {
        h1 { "Slip detectors: " (page.name) }
        (tiles(&tiles_of(page)))
        p {
            (page.trials) " trials of seed " (page.seed) ": random presses, drags, twists and holds on flat, round and cylindrical "
            "specimens that stand still, of friction 0.3 to 1.2, with rubber up to 10 % off its nominal stiffness. Every element counts in every "
            "frame at whose beginning it was pressed harder than " (page.touch_force) " N: " (samples) " times, " (slips)
            " of them slips, by the simulator's truth. Thresholds were chosen on as many other trials."
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
            "In brackets 95 % confidence, by drawing whole trials again (bootstrap)."
            @if page.trials == 1 { " One trial has no interval." }
            " The shear rate's threshold is in N/s, that of missing shear in N. "
            "On what may move, shear that all touching elements miss alike counts as motion of what they touch. "
            "A slip begins after five frames without, and counts as never noticed after ten."
        }
    };
    let title = format!("Slip detectors: {}", page.name);
    document(&title, body, &PageData::of_figures(&title, &[roc]))
}

/// What each detector notices with the threshold that was chosen for it.
fn tiles_of(page: &SlipPage) -> Vec<Tile> {
    let chosen = page.curves.iter().filter_map(|curve| {
        let point = page.points.iter().rfind(|point| point.name == curve.name)?;
        let percent = |share: [f64; 3]| significant(100.0 * share[1]);
        let right = percent(point.precision?);
        let label = format!(
            "of slips noticed by {}, {right} % of alarms right",
            curve.name
        );
        Some(Tile::new(percent(point.recall?), "%", label))
    });
    chosen.collect()
}
