//! Figure of slip detectors: slips noticed against false alarms.

use super::super::slip_page::Roc;
use super::canvas::{Pen, finger_colour, frame, line, panel};
use kuva::render::figure::Figure as Panels;

/// Fewest false alarms that are drawn, %: where precision is of interest, they are far below one percent.
const LEAST: f64 = 0.01;

/// The receiver operating characteristic of each detector, %.
pub fn roc_figure(curves: &[Roc], number: u32) -> String {
    let pen = |index| Pen::solid(finger_colour(index), 2.0);
    let percent = |&(x, y): &(f64, f64)| ((100.0 * x).max(LEAST), 100.0 * y);
    let lines = curves.iter().enumerate();
    let lines = lines.map(|(index, curve)| line(curve.points.iter().map(percent), pen(index)));
    let layout = panel(
        (LEAST, 100.0),
        (0.0, 100.0),
        "false alarms (%)",
        "slips noticed (%)",
    )
    .with_log_x();
    let panels = Panels::new(1, 1)
        .with_plots(vec![lines.collect()])
        .with_layouts(vec![layout]);
    let names = curves.iter().enumerate();
    let legend: Vec<_> = names
        .map(|(index, curve)| (curve.name, pen(index)))
        .collect();
    frame(
        number,
        "Slips noticed against false alarms",
        &legend,
        panels,
        360.0,
    )
}
