//! ROC figure of slip detectors: detection rate against false alarm rate.

use super::Figure;
use crate::figures::drawing::canvas::{Pen, dots, finger_colour, line, panel};
use crate::figures::drawing::sheet::tiled;
use crate::page_data::panels::{Colour, Points, Series};

/// Receiver operating characteristic of a detector.
#[derive(Debug, Clone, PartialEq)]
pub struct Roc {
    /// Name of the detector.
    pub name: &'static str,
    /// False alarm rate and detection rate at each threshold.
    pub points: Vec<(f64, f64)>,
}

/// Result of a detector at one threshold.
pub struct Mark {
    /// Name of the result.
    pub name: String,
    /// Index of the detector.
    pub detector: usize,
    /// False alarm rate and detection rate.
    pub at: (f64, f64),
    /// 95 % interval of the detection rate, if known.
    pub interval: Option<(f64, f64)>,
    /// Additional text, if any.
    pub label: Option<String>,
}

/// ROC curves of detectors, each with the detector's index, and results at single thresholds (%). The axis of the false
/// alarm rate starts at `least` (%) and is logarithmic unless `least` is 0.
pub fn roc_figure(
    curves: &[(usize, &Roc)],
    marks: &[Mark],
    least: f64,
    caption: &str,
    number: u32,
) -> Figure {
    let title = "Slips detected against false alarms";
    let pen = |detector| Pen::solid(finger_colour(detector), 2.0);
    let drawn = |(x, y): (f64, f64)| ((100.0 * x).max(least), 100.0 * y);
    let lines = curves.iter().map(|&(detector, curve)| {
        let points = curve.points.iter().copied();
        line(points.map(drawn), pen(detector))
    });
    let dots = marks.iter().map(|mark| {
        let colour = finger_colour(mark.detector);
        dots(&[drawn(mark.at)], 1, colour, 5.0)
    });
    let plots = lines.chain(dots).collect();
    let layout = panel(
        (least, 100.0),
        (0.0, 100.0),
        "false alarms (%)",
        "slips detected (%)",
    );
    let layout = match least > 0.0 {
        true => layout.with_log_x(),
        false => layout,
    };
    let legend = curves
        .iter()
        .map(|&(detector, curve)| (curve.name, pen(detector)));
    let legend: Vec<_> = legend.collect();
    let mut drawing = tiled((number, title), &legend, vec![(plots, layout)], 1, 360.0);
    for panel in &mut drawing.panels {
        // Replaces the unlabelled dots.
        panel.series.truncate(curves.len());
        let marks = marks.iter().map(|mark| mark.series(drawn(mark.at)));
        panel.series.extend(marks);
    }
    Figure::drawn(number, title, caption, Some(drawing))
}

impl Mark {
    /// Interactive dot at a point (%).
    fn series(&self, at: (f64, f64)) -> Series {
        let interval = self.interval.map(|(low, high)| (100.0 * low, 100.0 * high));
        let points = Points {
            label: self.label.iter().cloned().collect(),
            ..Points::new([at]).within(interval)
        };
        Series::of_points(&self.name, Colour::Finger(self.detector), points).dotted()
    }
}
