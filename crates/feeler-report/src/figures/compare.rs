//! Figures of a comparison: a measure of each control law against what varies.

use super::super::compare_page::Figure;
use super::canvas::{Pen, finger_colour, frame, line, panel, range};
use kuva::plot::BandPlot;
use kuva::render::figure::Figure as Panels;
use kuva::render::plots::Plot;

/// One curve a law, with the band of its 95 % confidence.
pub fn curves_figure(figure: &Figure, number: u32) -> String {
    let (mut plots, mut legend) = (Vec::new(), Vec::new());
    for (index, curve) in figure.curves.iter().enumerate() {
        let pen = Pen::solid(finger_colour(index), 2.0);
        let x = || curve.points.iter().map(|(x, _)| *x);
        let y = |which: usize| curve.points.iter().map(move |(_, y)| y[which]);
        let band = BandPlot::new(x(), y(0), y(2))
            .with_color(pen.colour)
            .with_opacity(0.2);
        plots.extend([Plot::Band(band), line(x().zip(y(1)), pen)]);
        legend.push((curve.law, pen));
    }
    let points = || figure.curves.iter().flat_map(|curve| &curve.points);
    let across = range(points().map(|(x, _)| *x)).unwrap_or((0.0, 1.0));
    let (low, high) = range(points().flat_map(|(_, y)| *y)).unwrap_or((0.0, 1.0));
    let layout = panel(
        across,
        (low.min(0.0), 1.05 * high),
        &figure.against,
        &figure.title,
    );
    let panels = Panels::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout]);
    let title = format!("{} against {}", figure.title, figure.against);
    frame(number, &title, &legend, panels, 270.0)
}
