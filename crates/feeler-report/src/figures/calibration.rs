//! Figures of a calibration: errors by element, curves and residuals of one.

use super::super::calibration_page::{CalibrationPage, ElementLoads};
use super::canvas::{Pen, finger_colour, frame, line, panel, range};
use kuva::plot::ScatterPlot;
use kuva::render::figure::Figure as Panels;
use kuva::render::plots::Plot;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Most dots of one panel: more tell no more.
const DOTS: usize = 200;

/// Root mean square errors of all elements, % of full scale.
pub fn errors_figure(page: &CalibrationPage) -> String {
    let percent = |axis: usize| {
        let elements = page.elements.iter().enumerate();
        elements.map(move |(index, element)| {
            (
                index as f64,
                100.0 * element.rms[axis] / page.full_scale[axis],
            )
        })
    };
    let pens: Vec<_> = (0..3)
        .map(|axis| Pen::solid(finger_colour(axis), 1.6))
        .collect();
    let plots = (0..3).map(|axis| line(percent(axis), pens[axis])).collect();
    let largest = range((0..3).flat_map(|axis| percent(axis).map(|p| p.1))).map_or(1.0, |r| r.1);
    let last = page.elements.len().saturating_sub(1) as f64;
    let layout = panel(
        (0.0, last),
        (0.0, 1.1 * largest),
        "element",
        "% of full scale",
    );
    let panels = Panels::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout]);
    let legend: Vec<_> = AXES.into_iter().zip(pens).collect();
    frame(1, "Held-out errors by element", &legend, panels, 300.0)
}

/// Loads, curves and residuals of one element, a row for each of x, y and z.
pub fn loads_figure(element: &ElementLoads, number: u32) -> String {
    let mut plots = Vec::new();
    let mut layouts = Vec::new();
    for (axis, name) in AXES.into_iter().enumerate() {
        let pen = Pen::solid(finger_colour(axis), 1.4);
        let mut drawn = vec![dots(&element.loads[axis], "#999999")];
        drawn.extend(
            element.curves[axis]
                .iter()
                .map(|curve| line(curve.iter().copied(), pen)),
        );
        plots.push(drawn);
        let input = match axis {
            2 => "growth of G".to_owned(),
            _ => format!("u_{name} ({})", element.length_unit),
        };
        layouts.push(over(&element.loads[axis], &input, &format!("F_{name} (N)")));
        plots.push(vec![dots(&element.residuals[axis], pen.colour)]);
        let load = format!("F_{name} (N)");
        layouts.push(over(&element.residuals[axis], &load, "error (mN)"));
    }
    let panels = Panels::new(3, 2)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_spacing(6.0)
        .with_padding(6.0);
    let title = format!("{}: curves and residuals", element.name);
    let legend = [
        ("loads", Pen::solid("#999999", 2.0)),
        ("x", Pen::solid(finger_colour(0), 2.0)),
        ("y", Pen::solid(finger_colour(1), 2.0)),
        ("z", Pen::solid(finger_colour(2), 2.0)),
    ];
    frame(number, &title, &legend, panels, 660.0)
}

/// An empty panel that holds all points.
fn over(points: &[(f64, f64)], x_label: &str, y_label: &str) -> kuva::render::layout::Layout {
    let x = range(points.iter().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let y = range(points.iter().map(|p| p.1)).unwrap_or((0.0, 1.0));
    panel(x, y, x_label, y_label).with_ticks(4)
}

/// Dots at points, evenly thinned, without those that are no numbers.
fn dots(points: &[(f64, f64)], colour: &str) -> Plot {
    let step = points.len().div_ceil(DOTS).max(1);
    let known = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
    let points: Vec<_> = points.iter().step_by(step).copied().filter(known).collect();
    let plot = ScatterPlot::new().with_data(points).with_color(colour);
    Plot::Scatter(plot.with_size(1.6))
}
