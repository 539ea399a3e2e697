//! Common parts of all figures: lines, panels and the frame around them.
//!
//! A figure is 480 units wide with 14-unit text, so that it is readable on a phone and in a page column. The frame
//! (title for screen readers, `viewBox`, legend above the panels) is drawn here; the panels are drawn by kuva.

pub use super::pen::{CAP, Pen, REFERENCE, SHADE, Style, finger_colour, stroke_colour};
use crate::measures::series::finite;
use kuva::backend::svg::SvgBackend;
use kuva::plot::{BandPlot, LinePlot, LineStyle, ScatterPlot};
use kuva::render::annotations::ShadedRegion;
use kuva::render::figure::Figure as Panels;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use maud::{Markup, PreEscaped, html};
use std::sync::Arc;

/// Width of a figure.
pub const WIDTH: f64 = 480.0;

/// Maximum number of strokes whose MOVE is shaded; shades of more strokes are too narrow to distinguish.
pub const MAX_SHADED: usize = 100;

/// Number of buckets to which a series over time is decimated.
pub const BUCKETS: usize = 480;

const LEGEND_HEIGHT: f64 = 30.0;
const LEGEND_LINE: f64 = 22.0;
const FONT: &str = "DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif";

/// Legend entries of the fingers.
pub fn finger_legend(fingers: usize, width: f64) -> Vec<(&'static str, Pen)> {
    const NAMES: [&str; 5] = ["finger 0", "finger 1", "finger 2", "finger 3", "finger 4"];
    let names = NAMES.iter().enumerate().take(fingers);
    names
        .map(|(f, name)| (*name, Pen::solid(finger_colour(f), width)))
        .collect()
}

/// A line through the points with finite coordinates.
pub fn line(points: impl IntoIterator<Item = (f64, f64)>, pen: Pen) -> Plot {
    let known = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
    let points: Vec<_> = points.into_iter().filter(known).collect();
    let line = LinePlot::new()
        .with_data(points)
        .with_color(pen.colour)
        .with_stroke_width(pen.width);
    Plot::Line(match pen.style.dashes() {
        Some(dashes) => line.with_line_style(LineStyle::Custom(dashes.into())),
        None => line,
    })
}

/// A line through the middle values, with a band between the interval ends; omits points that are not finite.
pub fn line_in_band(points: impl IntoIterator<Item = (f64, [f64; 3])>, pen: Pen) -> [Plot; 2] {
    let known = |(x, y): &(f64, [f64; 3])| x.is_finite() && y.iter().all(|y| y.is_finite());
    let points: Vec<_> = points.into_iter().filter(known).collect();
    let x = || points.iter().map(|(x, _)| *x);
    let y = |which: usize| points.iter().map(move |(_, y)| y[which]);
    let band = BandPlot::new(x(), y(0), y(2))
        .with_color(pen.colour)
        .with_opacity(0.2);
    [Plot::Band(band), line(x().zip(y(1)), pen)]
}

/// Dots at the points with finite coordinates, evenly decimated to at most `most`.
pub fn dots(points: &[(f64, f64)], most: usize, colour: &str, size: f64) -> Plot {
    let step = points.len().div_ceil(most).max(1);
    let known = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
    let points: Vec<_> = points.iter().step_by(step).copied().filter(known).collect();
    let plot = ScatterPlot::new().with_data(points).with_color(colour);
    Plot::Scatter(plot.with_size(size))
}

/// An empty panel with the given axis ranges. Ranges without width are widened.
pub fn panel(x: (f64, f64), y: (f64, f64), x_label: &str, y_label: &str) -> Layout {
    let layout = Layout::new(widen(x), widen(y))
        .with_label_size(14)
        .with_tick_size(13)
        .with_body_size(13)
        .with_grid_line_width(0.6)
        .with_tick_format(TickFormat::Custom(Arc::new(tick)))
        .with_y_label(y_label);
    if x_label.is_empty() {
        layout
    } else {
        layout.with_x_label(x_label)
    }
}

/// Like [`panel`], but the axes end exactly at the ends of the ranges.
pub fn exact_panel(x: (f64, f64), y: (f64, f64), x_label: &str, y_label: &str) -> Layout {
    panel(x, y, x_label, y_label)
        .with_x_axis_min(x.0)
        .with_x_axis_max(x.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1)
}

/// Shades ranges of x.
pub fn shaded(layout: Layout, spans: impl IntoIterator<Item = (f64, f64)>) -> Layout {
    spans.into_iter().fold(layout, |layout, (start, end)| {
        let shade = ShadedRegion::vertical(start, end).with_color(SHADE);
        layout.with_shaded_region(shade.with_opacity(0.55))
    })
}

/// Shades the MOVE phases of strokes on a time axis, unless there are too many to distinguish. Left and right margins
/// are fixed, so that the time axes of all panels align.
pub fn with_moves(layout: Layout, moves: Vec<(f64, f64)>) -> Layout {
    const MARGINS: (f64, f64) = (64.0, 20.0);
    let layout = layout.with_force_margins(MARGINS.0, MARGINS.1);
    match moves.len() > MAX_SHADED {
        true => layout,
        false => shaded(layout, moves),
    }
}

/// Short tick label with a proper minus sign.
fn tick(value: f64) -> String {
    let rounded = (value * 1e4).round() / 1e4;
    let text = rounded.abs().to_string();
    if rounded < 0.0 {
        format!("\u{2212}{text}")
    } else {
        text
    }
}

/// The range, or a range of width 1 if it has no width or is not finite.
fn widen((low, high): (f64, f64)) -> (f64, f64) {
    match (finite(low), finite(high)) {
        (Some(low), Some(high)) if high - low > 1e-9 => (low, high),
        (Some(low), _) => (low, low + 1.0),
        _ => (0.0, 1.0),
    }
}

/// Range of the finite values; `None` if no value is finite.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    (values.into_iter().filter(|v| v.is_finite())).fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((low, high)) => Some((v.min(low), v.max(high))),
    })
}

/// The range with a margin, so that dots at its ends are not clipped.
pub fn airy((low, high): (f64, f64)) -> (f64, f64) {
    let air = 0.05 * (high - low);
    (low - air, high + air)
}

/// Decimates a series to the smallest and largest value of each of `buckets` buckets, in order, so that no peak is
/// lost.
pub fn thin(points: &[(f64, f64)], buckets: usize) -> Vec<(f64, f64)> {
    if points.len() <= 2 * buckets {
        return points.to_vec();
    }
    let size = points.len().div_ceil(buckets);
    let mut thinned = Vec::with_capacity(2 * buckets);
    for bucket in points.chunks(size) {
        let ends = (bucket.iter().enumerate()).fold((0, 0), |(low, high), (i, point)| {
            let low = if point.1 < bucket[low].1 { i } else { low };
            let high = if point.1 > bucket[high].1 { i } else { high };
            (low, high)
        });
        let (first, second) = (ends.0.min(ends.1), ends.0.max(ends.1));
        thinned.push(bucket[first]);
        if second != first {
            thinned.push(bucket[second]);
        }
    }
    thinned
}

/// Places panels in a frame with a legend.
pub fn frame(
    number: u32,
    title: &str,
    legend: &[(&str, Pen)],
    panels: Panels,
    height: f64,
) -> String {
    let scene = panels.with_figure_size(WIDTH, height).render();
    let panels = own_ids(&SvgBackend.render_scene(&scene), number);
    let rows = legend_rows(legend);
    let legend_height = rows.len() as f64 * LEGEND_HEIGHT;
    let body = html! {
        @for (row, entries) in rows.iter().enumerate() {
            @let y = LEGEND_HEIGHT * (row as f64 + 0.5);
            @for (x, text, pen) in entries {
                line x1=(x) x2=(x + LEGEND_LINE) y1=(y) y2=(y) stroke=(pen.colour)
                    stroke-width=(pen.width.max(2.0))
                    stroke-dasharray=[pen.style.dashes()] {}
                text x=(x + LEGEND_LINE + 6.0) y=(y + 5.0) { (text) }
            }
        }
        g transform=(format!("translate(0,{legend_height})")) { (PreEscaped(panels)) }
    };
    sheet(number, title, height + legend_height, body)
}

/// An SVG document with white background, the common font and a title for screen readers.
pub fn sheet(number: u32, title: &str, height: f64, body: Markup) -> String {
    let heading = format!("fig-{number:02}-title");
    html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(WIDTH) height=(height)
            viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-labelledby=(heading) {
            title id=(heading) { (title) }
            rect width=(WIDTH) height=(height) fill="white" {}
            g font-family=(FONT) font-size="14" { (body) }
        }
    }
    .into_string()
}

/// Legend entries arranged in rows, each with its left end.
fn legend_rows<'a>(legend: &[(&'a str, Pen)]) -> Vec<Vec<(f64, &'a str, Pen)>> {
    /// Average width of a legend character, with some margin.
    const LETTER: f64 = 8.0;
    /// Left end of each row of the legend.
    const START: f64 = 16.0;
    let mut rows = vec![Vec::new()];
    let mut x = START;
    for &(text, pen) in legend {
        let width = LEGEND_LINE + 6.0 + LETTER * text.chars().count() as f64 + 14.0;
        if x + width > WIDTH && x > START {
            rows.push(Vec::new());
            x = START;
        }
        if let Some(row) = rows.last_mut() {
            row.push((x, text, pen));
        }
        x += width;
    }
    rows
}

/// Renames the clip paths of a figure so that ids are unique within a page.
fn own_ids(svg: &str, number: u32) -> String {
    const THEIRS: &str = "kuva-clip-";
    let mut names: Vec<&str> = Vec::new();
    let mut out = String::with_capacity(svg.len());
    let mut rest = svg;
    while let Some(at) = rest.find(THEIRS) {
        let (before, named) = rest.split_at(at);
        let end = THEIRS.len()
            + named[THEIRS.len()..]
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(named.len() - THEIRS.len());
        let (name, after) = named.split_at(end);
        let place = names.iter().position(|n| *n == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        });
        out += before;
        out += &format!("fig-{number:02}-clip-{place}");
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak() {
        let mut points: Vec<_> = (0..10_000).map(|i| (f64::from(i), 0.0)).collect();
        points[4321].1 = 5.0;
        points[8765].1 = -3.0;
        let thinned = thin(&points, 300);
        assert!(thinned.len() <= 600);
        assert!(thinned.contains(&(4321.0, 5.0)) && thinned.contains(&(8765.0, -3.0)));
        assert!(thinned.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!(thin(&points[..100], 300), points[..100]);
    }

    #[test]
    fn clip_path_ids_are_unique_to_the_figure() {
        let svg = r##"<clipPath id="kuva-clip-12"/><g clip-path="url(#kuva-clip-12)"/><a b="kuva-clip-7"/>"##;
        assert_eq!(
            own_ids(svg, 8),
            r##"<clipPath id="fig-08-clip-0"/><g clip-path="url(#fig-08-clip-0)"/><a b="fig-08-clip-1"/>"##
        );
    }

    #[test]
    fn wide_legend_wraps_to_another_row() {
        let pen = Pen::solid(CAP, 1.0);
        let long = "a legend entry of forty letters, or more";
        assert_eq!(legend_rows(&[(long, pen), (long, pen)]).len(), 2);
        assert_eq!(
            legend_rows(&[("finger 0", pen), ("finger 1", pen)]).len(),
            1
        );
    }
}
