//! Static drawings and the interactive panels that replace them.

use super::canvas::{CAP, Pen, REFERENCE, finger_colour, frame, thin};
use super::grid;
use crate::page_data::panels::{Axis, COLOURS, Colour, Line, Panel, Points, Series};
use crate::pages::text::name_and_unit;
use kuva::plot::{BandPlot, LinePlot, LineStyle};
use kuva::render::figure::Figure as Panels;
use kuva::render::plots::Plot;

/// Padding around all panels.
const PADDING: f64 = 6.0;
/// Number of buckets to which a line over time is decimated.
const BUCKETS: usize = 600;
/// Label of time axes.
const TIME: &str = "Time (s)";

/// A static drawing with its interactive replacement.
pub struct Drawing {
    /// SVG document.
    pub svg: String,
    /// Interactive panels with the same content.
    pub panels: Vec<Panel>,
    /// Number of panels side by side.
    pub columns: usize,
}

/// Panels below each other with a shared x axis, under a legend.
pub fn column(
    head: (u32, &str),
    legend: &[(&str, Pen)],
    panels: Vec<grid::Panel>,
    height: f64,
) -> Drawing {
    let of_time = |panel: &grid::Panel| panel.1.x_label.as_deref() == Some(TIME);
    let of_time = panels.iter().any(of_time);
    let arranged = Panels::new(panels.len(), 1)
        .with_shared_x_all()
        .with_spacing(0.0);
    let svg = |drawn| frame(head.0, head.1, legend, drawn, height);
    drawing(arranged, 1, legend, of_time, panels, svg)
}

/// Panels with separate axes, arranged in `columns`, under a legend. Each row has height `height`.
pub fn tiled(
    head: (u32, &str),
    legend: &[(&str, Pen)],
    panels: Vec<grid::Panel>,
    columns: usize,
    height: f64,
) -> Drawing {
    let rows = panels.len().div_ceil(columns).max(1);
    let arranged = Panels::new(rows, columns).with_spacing(PADDING);
    let svg = |drawn| frame(head.0, head.1, legend, drawn, height * rows as f64);
    drawing(arranged, columns, legend, false, panels, svg)
}

/// Creates the drawing and the interactive version of each panel.
fn drawing(
    arranged: Panels,
    columns: usize,
    legend: &[(&str, Pen)],
    of_time: bool,
    panels: Vec<grid::Panel>,
    svg: impl FnOnce(Panels) -> String,
) -> Drawing {
    let answering = panels.iter().map(|panel| answering(panel, legend, of_time));
    let answering = answering.collect();
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let drawn = arranged
        .with_plots(plots)
        .with_layouts(layouts)
        .with_padding(PADDING);
    Drawing {
        svg: svg(drawn),
        panels: answering,
        columns,
    }
}

/// Interactive version of a drawn panel, in the displayed units.
fn answering((plots, layout): &grid::Panel, legend: &[(&str, Pen)], of_time: bool) -> Panel {
    let mut series: Vec<Series> = Vec::new();
    for (index, plot) in plots.iter().enumerate() {
        match plot {
            Plot::Line(line) => match index.checked_sub(1).map(|before| &plots[before]) {
                Some(Plot::Band(band)) => series.push(line_in_band(line, band, legend)),
                _ => add_line(&mut series, line, legend, of_time),
            },
            Plot::Scatter(dots) => {
                let points = Points::new(dots.data.iter().map(|point| (point.x, point.y)));
                let name = name(legend, &dots.color, None);
                series.push(Series::of_points(name, colour(&dots.color), points).dotted());
            }
            _ => {}
        }
    }
    let y = axis(layout.y_label.as_deref(), layout.y_range);
    let thresholds = layout.reference_lines.iter();
    let panel = match of_time {
        true => Panel::over_time(y, series),
        false => {
            let mut x = axis(layout.x_label.as_deref(), layout.x_range);
            x.log = layout.log_x;
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

/// Adds a line to the series. Pieces of the same line are joined to one series. On a time axis, a piece that is earlier
/// than the existing ones starts a new series, because lines do not run backwards.
fn add_line(series: &mut Vec<Series>, line: &LinePlot, legend: &[(&str, Pen)], of_time: bool) {
    let name = name_of(line, legend);
    let mut points: Vec<_> = line.data.iter().map(|point| (point.x, point.y)).collect();
    if of_time {
        points = thin(&points, BUCKETS);
    }
    let begin = points.first().map_or(f64::NEG_INFINITY, |point| point.0);
    let goes_on = |series: &&mut Series| {
        let end = series.points.as_ref().and_then(|points| points.x.last());
        let is_later = end.is_some_and(|end| *end <= begin);
        series.name == name && !name.is_empty() && (is_later || !of_time)
    };
    let before = series.iter_mut().find(goes_on);
    match before.and_then(|series| series.points.as_mut()) {
        Some(before) => before.append(points),
        None => series.push(Series {
            line: match line.line_style {
                LineStyle::Solid => Line::Solid,
                _ => Line::Dashed,
            },
            ..Series::of_points(name, colour(&line.color), Points::new(points))
        }),
    }
}

/// A line with its interval band.
fn line_in_band(line: &LinePlot, band: &BandPlot, legend: &[(&str, Pen)]) -> Series {
    let points = Points::new(line.data.iter().map(|point| (point.x, point.y)));
    let ends = band
        .y_lower
        .iter()
        .copied()
        .zip(band.y_upper.iter().copied());
    let points = points.within(ends);
    Series::of_points(name_of(line, legend), colour(&line.color), points)
}

/// Name of a line in the legend.
fn name_of(line: &LinePlot, legend: &[(&str, Pen)]) -> String {
    let is_solid = matches!(line.line_style, LineStyle::Solid);
    name(legend, &line.color, Some(is_solid))
}

/// Name in the legend of an item with this colour and line style; empty if the legend has no such item.
fn name(legend: &[(&str, Pen)], colour: &str, is_solid: Option<bool>) -> String {
    let same = |(_, pen): &&(&str, Pen)| {
        let solid = pen.style.dashes().is_none();
        pen.colour == colour && is_solid.is_none_or(|is_solid| is_solid == solid)
    };
    let entry = legend.iter().find(same);
    entry.map_or_else(String::new, |(name, _)| (*name).into())
}

/// Name of horizontal lines: that of the last legend entry with a dashed or dotted line.
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
            let finger = (0..COLOURS).find(|&finger| finger_colour(finger) == drawn);
            finger.map_or(Colour::Background, Colour::Finger)
        }
    }
}

/// Axis for a label such as `Torque (mN·m)`.
fn axis(label: Option<&str>, range: (f64, f64)) -> Axis {
    let (label, unit) = name_and_unit(label.unwrap_or_default());
    let mut axis = Axis::new(label, unit.to_string(), 1.0);
    axis.range = (range.0 < range.1).then_some(range);
    axis
}
