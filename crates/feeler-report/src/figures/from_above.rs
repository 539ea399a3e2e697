//! Top view of a stroke: the cap, the paths of the dome centres, and the paths of the touching tips.

use super::unrolled::{Step, Unrolled};
use crate::figures::drawing::canvas::{
    CAP, Pen, REFERENCE, WIDTH, exact_panel, finger_colour, line, range,
};
use crate::figures::drawing::grid::{Panel, Row};
use crate::measures::paths::MM;
use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use feeler_record::RunFacts;
use glam::{DVec2, DVec3};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use std::f64::consts::TAU;

/// Line width of the main path.
pub const BOLD: f64 = 2.6;
/// Pen of the touching elements other than the leading one.
pub const TOUCHING: Pen = Pen::solid("#888888", 1.0);
/// Pen of the planned line.
pub const PLANNED: Pen = Pen::dashed(REFERENCE, 1.4);
/// Pen of the arc about the cap's axis.
pub const ARC: Pen = Pen::dotted(CAP, 1.8);
/// Pen of the cap's contour.
pub const CONTOUR: Pen = Pen::solid(CAP, 1.8);
/// Pen of the circle on which the centre of a just touching tip lies.
pub const JUST_TOUCHING: Pen = Pen::dashed("#999999", 1.0);

/// Ranges of x and y.
type Window = ((f64, f64), (f64, f64));

/// The cap (if its position is known) with the paths of the dome centres, scaled to the width of the figure.
pub fn overview(data: &RunData, stroke: &Stroke) -> Option<Row> {
    /// Margin around the content (mm).
    const MARGIN: f64 = 2.0;
    /// Width of labels beside the panel, and their height above and below it.
    const LABELS: (f64, f64) = (84.0, 56.0);
    let cap = cap_above(data, stroke);
    let mut plots = cap_outline(data, cap);
    for finger in 0..data.fingers.len() {
        plots.extend(tip_paths(data, stroke, finger));
        plots.extend(centre_paths(data, stroke, finger));
    }
    let (x, y) = overview_window(data, cap)?;
    let widen = |(low, high): (f64, f64)| (MM * low - MARGIN, MM * high + MARGIN);
    let (x, y) = (widen(x), widen(y));
    let scale = (WIDTH - LABELS.0) / (x.1 - x.0);
    Some(Row {
        height: (LABELS.1 + scale * (y.1 - y.0)).clamp(160.0, 400.0),
        panels: vec![(plots, plan((x, y), true, 10.0))],
    })
}

/// Close-ups of the touching tips, one per finger, all with the same scale and the same axes for strokes 1 and 4.
pub fn close_ups(data: &RunData, stroke: &Stroke) -> Option<Vec<Panel>> {
    let cap = cap_above(data, stroke);
    let close_up = |finger: usize| {
        let mut plots = cap_outline(data, cap);
        plots.extend(tip_paths(data, stroke, finger));
        let window = close_up_window(data, finger)?;
        Some((plots, plan(window, finger == 0, 5.0)))
    };
    (0..data.fingers.len()).map(close_up).collect()
}

/// Axes of a top view with ticks every `ticks` millimetres. Only the `first` panel of a row labels its y axis.
fn plan((x, y): Window, first: bool, ticks: f64) -> Layout {
    exact_panel(x, y, "x (mm)", if first { "y (mm)" } else { "" })
        .with_equal_aspect()
        .with_x_tick_step(ticks)
        .with_y_tick_step(ticks)
}

/// Position of the cap's axis when MOVE starts (m); `None` unless it and the cap's radius are known.
pub fn cap_above(data: &RunData, stroke: &Stroke) -> Option<DVec2> {
    let centre = data.cap.as_ref()?.centre.get(stroke.moving.start)?;
    let known = centre.is_finite() && data.facts.cap_radius > 0.0;
    known.then(|| centre.truncate())
}

/// The cap's contour, and the circle on which the centre of a just touching tip lies.
fn cap_outline(data: &RunData, centre: Option<DVec2>) -> Vec<Plot> {
    let Some(centre) = centre else {
        return Vec::new();
    };
    let circle = |radius: f64, pen| {
        let points = (0..=240).map(|i| {
            let angle = TAU * f64::from(i) / 240.0;
            let point = centre + radius * DVec2::from_angle(angle);
            (MM * point.x, MM * point.y)
        });
        line(points, pen)
    };
    let RunFacts {
        cap_radius,
        feeler_tip_radius,
        ..
    } = data.facts;
    let mut plots = vec![circle(cap_radius, CONTOUR)];
    if feeler_tip_radius > 0.0 {
        plots.push(circle(cap_radius + feeler_tip_radius, JUST_TOUCHING));
    }
    plots
}

/// Path of a dome's centre over MOVE (bold), with the planned line and, if the axis is known, the arc about it.
fn centre_paths(data: &RunData, stroke: &Stroke, finger: usize) -> Vec<Plot> {
    let Some(unrolled) = Unrolled::new(data, stroke, finger) else {
        return Vec::new();
    };
    let path = |point: fn(&Step) -> DVec3, pen| {
        draw(&unrolled.steps.iter().map(point).collect::<Vec<_>>(), pen)
    };
    let mut plots = vec![
        path(|step| step.centre, Pen::solid(finger_colour(finger), BOLD)),
        path(|step| step.on_line, PLANNED),
    ];
    plots.extend(unrolled.has_arc().then(|| path(|step| step.on_arc, ARC)));
    plots
}

/// A finger's tips over MOVE: the planned segment, every touching element, and the leading element (bold).
fn tip_paths(data: &RunData, stroke: &Stroke, finger: usize) -> Vec<Plot> {
    let columns = &data.fingers[finger];
    let mut plots = Vec::new();
    let elements = (stroke.moving.clone())
        .map(|row| columns.forces[row].len())
        .max()
        .unwrap_or(0);
    for element in 0..elements {
        let touching = |row: usize| {
            let force = columns.forces[row].get(element)?;
            (force.z > data.facts.touch_force_threshold).then(|| columns.tip(row, element))?
        };
        plots.extend(stretches(stroke, touching).map(|path| draw(&path, TOUCHING)));
    }
    if let Some(segment) = planned_segment(data, stroke, finger) {
        plots.push(draw(&segment, PLANNED));
    }
    let pen = Pen::solid(finger_colour(finger), BOLD);
    let leading = columns.leading_path(stroke);
    plots.extend(leading.map(|path| draw(&path, pen)));
    plots
}

/// Contiguous stretches of a path over MOVE, split where `point` is `None`.
fn stretches<'a>(
    stroke: &'a Stroke,
    point: impl Fn(usize) -> Option<DVec3> + 'a,
) -> impl Iterator<Item = Vec<DVec3>> + 'a {
    let mut rows = stroke.moving.clone().peekable();
    std::iter::from_fn(move || {
        while rows.next_if(|&row| point(row).is_none()).is_some() {}
        rows.peek()?;
        let mut path = Vec::new();
        while let Some(row) = rows.next_if(|&row| point(row).is_some()) {
            path.extend(point(row));
        }
        Some(path)
    })
    .filter(|path| path.len() > 1)
}

/// Segment along which the tip of the leading element would have moved in the planned direction, over the actual
/// travel.
fn planned_segment(data: &RunData, stroke: &Stroke, finger: usize) -> Option<[DVec3; 2]> {
    let columns = &data.fingers[finger];
    let direction = data.direction(finger)?;
    let start = *columns.leading_path(stroke)?.first()?;
    let path = data.path(stroke, finger)?;
    let travel = (*path.last()? - *path.first()?).dot(direction);
    Some([start, start + travel * direction])
}

/// Ranges (m) that contain the cap and the paths of the dome centres in strokes 1 and 4.
fn overview_window(data: &RunData, cap: Option<DVec2>) -> Option<Window> {
    let reach = DVec2::splat(data.facts.cap_radius + data.facts.feeler_tip_radius);
    let mut points: Vec<_> = (cap.iter().flat_map(|&axis| [axis - reach, axis + reach])).collect();
    for stroke in [1, 4].iter().filter_map(|&index| data.whole_stroke(index)) {
        for finger in 0..data.fingers.len() {
            let path = Unrolled::new(data, stroke, finger).into_iter();
            let steps = path.flat_map(|path| path.steps);
            points.extend(steps.flat_map(|s| [s.centre.truncate(), s.on_line.truncate()]));
        }
    }
    Some((
        range(points.iter().map(|p| p.x))?,
        range(points.iter().map(|p| p.y))?,
    ))
}

/// Ranges of x and y (mm) around a finger's leading tips in strokes 1 and 4, of equal size for all fingers.
fn close_up_window(data: &RunData, finger: usize) -> Option<Window> {
    const MARGIN: f64 = 1.5;
    let extents: Option<Vec<_>> = (0..data.fingers.len())
        .map(|finger| tips_extent(data, finger))
        .collect();
    let half = |(low, high): (f64, f64)| 0.5 * MM * (high - low) + MARGIN;
    let (half_x, half_y) = (extents.as_ref()?.iter()).fold((0.0, 0.0), |(x, y): (f64, f64), e| {
        (x.max(half(e.0)), y.max(half(e.1)))
    });
    let (x, y) = *extents?.get(finger)?;
    let around = |(low, high): (f64, f64), half: f64| {
        let middle = 0.5 * MM * (low + high);
        (middle - half, middle + half)
    };
    Some((around(x, half_x), around(y, half_y)))
}

/// Ranges of x and y (m) of a finger's leading tips and planned segments.
fn tips_extent(data: &RunData, finger: usize) -> Option<Window> {
    let columns = data.fingers.get(finger)?;
    let mut points = Vec::new();
    for stroke in [1, 4].iter().filter_map(|&index| data.whole_stroke(index)) {
        points.extend(columns.leading_path(stroke).into_iter().flatten());
        points.extend(planned_segment(data, stroke, finger).into_iter().flatten());
    }
    Some((
        range(points.iter().map(|p| p.x))?,
        range(points.iter().map(|p| p.y))?,
    ))
}

fn draw(path: &[DVec3], pen: Pen) -> Plot {
    line(path.iter().map(|p| (MM * p.x, MM * p.y)), pen)
}
