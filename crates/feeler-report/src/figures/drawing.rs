//! A picture, and what stands in its place where scripts run.

use super::super::page_data::panels::{Axis, Colour, Line, Panel, Points, Series};
use super::canvas::{CAP, Pen, finger_colour, frame, thin};
use super::grid;
use kuva::plot::{LinePlot, LineStyle};
use kuva::render::figure::Figure as Panels;
use kuva::render::plots::Plot;
use std::borrow::Cow;

/// Around all panels.
const PADDING: f64 = 6.0;
/// Pairs of points that a line of time is thinned to.
const BUCKETS: usize = 600;
/// What the axis of time is called.
const TIME: &str = "Time (s)";
/// Grey of what was planned, or is allowed.
const REFERENCE: &str = "#555555";

/// A picture, and the panels that answer in its place.
pub struct Drawing {
    /// The picture, a whole SVG document.
    pub svg: String,
    /// The same as panels.
    pub panels: Vec<Panel>,
}

/// Panels one below the other, which share what is along x, under a legend.
pub fn column(
    (number, title): (u32, &str),
    legend: &[(&str, Pen)],
    panels: Vec<grid::Panel>,
    height: f64,
) -> Drawing {
    let of_time = |panel: &grid::Panel| panel.1.x_label.as_deref() == Some(TIME);
    let of_time = panels.iter().any(of_time);
    let answering = panels.iter().map(|panel| answering(panel, legend, of_time));
    let answering = answering.collect();
    let count = panels.len();
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let drawn = Panels::new(count, 1)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_shared_x_all()
        .with_spacing(0.0)
        .with_padding(PADDING);
    Drawing {
        svg: frame(number, title, legend, drawn, height),
        panels: answering,
    }
}

/// A panel that shows what a drawn one does, in the units that it is drawn in.
fn answering((plots, layout): &grid::Panel, legend: &[(&str, Pen)], of_time: bool) -> Panel {
    let mut series: Vec<Series> = Vec::new();
    for line in plots.iter().filter_map(line_of) {
        let name = name(line, legend);
        let mut points: Vec<_> = line.data.iter().map(|point| (point.x, point.y)).collect();
        if of_time {
            points = thin(&points, BUCKETS);
        }
        let begin = points.first().map_or(f64::NEG_INFINITY, |point| point.0);
        // A line that is drawn in pieces goes on later; another of the same name begins anew.
        let goes_on = |series: &&mut Series| {
            let end = series.points.as_ref().and_then(|points| points.x.last());
            series.name == name && !name.is_empty() && end.is_some_and(|end| *end <= begin)
        };
        let before = series.iter_mut().find(goes_on);
        match before.and_then(|series| series.points.as_mut()) {
            Some(before) => before.append(points),
            None => series.push(Series {
                line: match line.line_style {
                    LineStyle::Solid => Line::Solid,
                    _ => Line::Dashed,
                },
                ..Series::of_points(name, colour(&line.color), Points::drawn(points))
            }),
        }
    }
    let y = axis(layout.y_label.as_deref(), layout.y_range);
    let thresholds = layout.reference_lines.iter();
    let panel = match of_time {
        true => Panel::over_time(y, series),
        false => {
            let x = axis(layout.x_label.as_deref(), layout.x_range);
            Panel::of(x, y, series)
        }
    };
    let panel = thresholds.fold(panel, |panel, line| {
        panel.with_threshold(line.value, reference_name(legend))
    });
    Panel {
        equal: layout.equal_aspect,
        ..panel
    }
}

fn line_of(plot: &Plot) -> Option<&LinePlot> {
    match plot {
        Plot::Line(line) => Some(line),
        _ => None,
    }
}

/// What the legend calls a line; nothing where it does not name it.
fn name(line: &LinePlot, legend: &[(&str, Pen)]) -> String {
    let is_solid = matches!(line.line_style, LineStyle::Solid);
    let same = |(_, pen): &&(&str, Pen)| {
        pen.colour == line.color && pen.style.dashes().is_none() == is_solid
    };
    legend
        .iter()
        .find(same)
        .map_or_else(String::new, |(name, _)| (*name).into())
}

/// What the legend calls a horizontal line: its last broken one.
fn reference_name<'a>(legend: &[(&'a str, Pen)]) -> &'a str {
    let mut broken = legend
        .iter()
        .filter(|(_, pen)| pen.style.dashes().is_some());
    broken.next_back().map_or("", |(name, _)| name)
}

fn colour(drawn: &str) -> Colour {
    match drawn {
        CAP => Colour::Shared,
        REFERENCE => Colour::Reference,
        drawn => {
            let finger = (0..4).find(|&finger| finger_colour(finger) == drawn);
            finger.map_or(Colour::Background, Colour::Finger)
        }
    }
}

/// An axis by its label, as in `Torque (mN·m)`.
fn axis(label: Option<&str>, range: (f64, f64)) -> Axis {
    let label = label.unwrap_or_default();
    let (label, unit) = label.rsplit_once(" (").unwrap_or((label, ""));
    let unit = Cow::Owned(unit.trim_end_matches(')').to_string());
    let mut axis = Axis::new(label, unit, 1.0);
    axis.range = (range.0 < range.1).then_some(range);
    axis
}
