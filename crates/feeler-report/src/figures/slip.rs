//! ROC figures of slip detectors: detection rate against false alarm rate.

use super::super::page_data::panels::{Colour, Points, Series};
use super::Figure;
use crate::figures::drawing::canvas::{Pen, dots, finger_colour, line, panel};
use crate::figures::drawing::sheet::tiled;
use crate::pages::grasp_slip::{GraspDetector, GraspSlipPage};
use crate::pages::slip::{OperatingPoint, SlipPage};
use crate::pages::text::significant;

/// Lower end of the false alarm axis (%). Precise detectors are far below one percent.
const LEAST: f64 = 0.01;

/// Receiver operating characteristic of each detector with its operating points (%).
pub fn roc_figure(page: &SlipPage, number: u32) -> Figure {
    let title = "Slips detected against false alarms";
    let pen = |index| Pen::solid(finger_colour(index), 2.0);
    let drawn = |(x, y): (f64, f64)| ((100.0 * x).max(LEAST), 100.0 * y);
    let curves = page.curves.iter().enumerate();
    let lines =
        curves.map(|(index, curve)| line(curve.points.iter().copied().map(drawn), pen(index)));
    let points = page.points.iter().filter_map(|point| {
        let at = drawn((point.false_alarms?[1], point.recall?[1]));
        Some(dots(&[at], 1, finger_colour(page.curve_of(point)?), 5.0))
    });
    let plots = lines.chain(points).collect();
    let layout = panel(
        (LEAST, 100.0),
        (0.0, 100.0),
        "false alarms (%)",
        "slips detected (%)",
    );
    let names = page.curves.iter().enumerate();
    let legend: Vec<_> = names
        .map(|(index, curve)| (curve.name, pen(index)))
        .collect();
    let panels = vec![(plots, layout.with_log_x())];
    let mut drawing = tiled((number, title), &legend, panels, 1, 360.0);
    for panel in &mut drawing.panels {
        // Replaces the unlabelled dots.
        panel.series.truncate(page.curves.len());
        let points = page.points.iter();
        panel
            .series
            .extend(points.filter_map(|point| operating_point(page.curve_of(point)?, point)));
    }
    let caption = "Curves are over all thresholds. Dots are the experiment's threshold and the chosen thresholds, with the 95 % interval of the detection rate.";
    Figure::drawn(number, title, caption, Some(drawing))
}

fn operating_point(curve: usize, point: &OperatingPoint) -> Option<Series> {
    let [low, recall, high] = point.recall?.map(|share| 100.0 * share);
    let alarms = (100.0 * point.false_alarms?[1]).max(LEAST);
    let points = Points::new([(alarms, recall)]).within([(low, high)]);
    let label = format!("precision {} %", point.fields()[1]);
    let points = Points {
        label: vec![label],
        ..points
    };
    let name = format!("{} above {}", point.name, significant(point.threshold));
    Some(Series::of_points(name, Colour::Finger(curve), points).dotted())
}

/// Receiver operating characteristic of each detector on recordings, with its result at thresholds from other groups
/// (%).
pub fn grasp_roc_figure(page: &GraspSlipPage, number: u32) -> Figure {
    let title = "Slips detected against false alarms";
    let pen = |index| Pen::solid(finger_colour(index), 2.0);
    let drawn = |(x, y): (f64, f64)| (100.0 * x, 100.0 * y);
    let known = page.detectors.iter().enumerate();
    let known: Vec<_> = known.filter(|(_, d)| !d.curve.points.is_empty()).collect();
    let lines = known.iter().map(|&(index, detector)| {
        line(detector.curve.points.iter().copied().map(drawn), pen(index))
    });
    let points = known.iter().filter_map(|&(index, detector)| {
        let at = drawn(judged(detector)?);
        Some(dots(&[at], 1, finger_colour(index), 5.0))
    });
    let plots = lines.chain(points).collect();
    let whole = (0.0, 100.0);
    let layout = panel(whole, whole, "false alarms (%)", "slips detected (%)");
    let legend: Vec<_> = (known.iter())
        .map(|&(index, detector)| (detector.name, pen(index)))
        .collect();
    let mut drawing = tiled((number, title), &legend, vec![(plots, layout)], 1, 360.0);
    for panel in &mut drawing.panels {
        // Replaces the unlabelled dots.
        panel.series.truncate(known.len());
        let points = known.iter().filter_map(|&(index, detector)| {
            let points = Points::new([drawn(judged(detector)?)]);
            let name = format!("{}, thresholds of other groups", detector.name);
            Some(Series::of_points(name, Colour::Finger(index), points).dotted())
        });
        panel.series.extend(points);
    }
    let caption = "Curves are over all thresholds. Dots are results with thresholds chosen on all other groups.";
    Figure::drawn(number, title, caption, Some(drawing))
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
