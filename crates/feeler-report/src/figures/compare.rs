//! Figures of a law comparison: measures against varied quantities, and two laws trial by trial.

use super::Figure;
use crate::figures::drawing::canvas::{
    Pen, REFERENCE, airy, dots, finger_colour, line, line_in_band, panel, range,
};
use crate::figures::drawing::grid;
use crate::figures::drawing::sheet::{Drawing, tiled};
use crate::page_data::panels::{COLOURS, Colour, Command, Line, Points, Series};

/// A measure of all laws as a function of a varied quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Name and unit of the measure.
    pub title: String,
    /// Varied quantity.
    pub against: String,
    /// One curve per law.
    pub curves: Vec<Curve>,
}

/// A measure of one law as a function of a varied quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the law.
    pub law: String,
    /// Value of the varied quantity, and mean with its 95 % confidence interval (`[low, mean, high]`).
    pub points: Vec<(f64, [f64; 3])>,
}

/// Paired comparison of two laws on the same trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// Name of the first law.
    pub first: String,
    /// Name of the other law.
    pub other: String,
    /// Compared measures.
    pub measures: Vec<PairedMeasure>,
}

/// A measure of two laws.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedMeasure {
    /// Name and unit of the measure.
    pub name: &'static str,
    /// For each trial with this measure under both laws: trial number, value of the first law, value of the other law.
    pub trials: Vec<(u64, f64, f64)>,
}

/// Maximum number of trials drawn in the static figure.
const MAX_DOTS: usize = 300;
/// Line on which both laws are equal.
const ALIKE: Pen = Pen::dashed(REFERENCE, 1.2);

/// One curve per law with its 95 % confidence band.
pub fn curves_figure(curves: &Curves, number: u32) -> Figure {
    let (mut plots, mut legend) = (Vec::new(), Vec::new());
    for (index, curve) in curves.curves.iter().enumerate() {
        // Colours repeat with dashed lines.
        let style = if index < COLOURS {
            Pen::solid
        } else {
            Pen::dashed
        };
        let pen = style(finger_colour(index), 2.0);
        plots.extend(line_in_band(curve.points.iter().copied(), pen));
        legend.push((curve.law.as_str(), pen));
    }
    let points = || curves.curves.iter().flat_map(|curve| &curve.points);
    let across = range(points().map(|(x, _)| *x)).unwrap_or((0.0, 1.0));
    let (low, high) = range(points().flat_map(|(_, y)| *y)).unwrap_or((0.0, 1.0));
    let upright = (low.min(0.0), 1.05 * high);
    let layout = panel(across, upright, &curves.against, &curves.title);
    let title = format!("{} against {}", curves.title, curves.against);
    let drawing = tiled((number, &title), &legend, vec![(plots, layout)], 1, 270.0);
    Figure::drawn(number, title, "", Some(drawing))
}

/// Two laws on the same trials: one panel per measure, one dot per trial.
pub fn pairs_figure(pairs: &Pairs, number: u32) -> Figure {
    let title = format!("{} and {}, trial by trial", pairs.first, pairs.other);
    let panels = pairs.measures.iter().map(|measure| {
        let of = |law: &str| format!("{law}: {}", measure.name);
        pair_panel(&measure.trials, &of(&pairs.first), &of(&pairs.other))
    });
    let legend = [
        ("trials", Pen::solid(finger_colour(1), 2.0)),
        ("equal", ALIKE),
    ];
    let panels: Vec<_> = panels.collect();
    let mut drawing = tiled((number, &title), &legend, panels, 2, 250.0);
    answer(&mut drawing, pairs);
    let caption = "Each dot is one trial under both laws with the same random draws; on the dashed line both are equal. Click a dot to copy \
        the command that repeats the trial under the second law.";
    Figure::drawn(number, title, caption, Some(drawing))
}

fn pair_panel(trials: &[(u64, f64, f64)], along: &str, upright: &str) -> grid::Panel {
    let points: Vec<_> = trials.iter().map(|&(_, x, y)| (x, y)).collect();
    let both = range(points.iter().flat_map(|&(x, y)| [x, y])).unwrap_or((0.0, 1.0));
    let plots = vec![
        line([(both.0, both.0), (both.1, both.1)], ALIKE),
        dots(&points, MAX_DOTS, finger_colour(1), 2.4),
    ];
    let axis = airy(both);
    (plots, panel(axis, axis, along, upright).with_ticks(4))
}

/// Adds the command of each trial to the interactive panels.
fn answer(drawing: &mut Drawing, pairs: &Pairs) {
    for (panel, PairedMeasure { trials, .. }) in drawing.panels.iter_mut().zip(&pairs.measures) {
        panel.series.retain(|series| series.line != Line::Points);
        let folder = format!("/{}", pairs.other);
        let numbers = trials.iter().map(|trial| trial.0).collect();
        let points = Points {
            command: Some(Command::of_trials(&folder, numbers)),
            ..Points::new(trials.iter().map(|&(_, x, y)| (x, y)))
        };
        let dots = Series::of_points("trials", Colour::Finger(1), points).dotted();
        panel.series.push(dots);
    }
}
