//! Figs. 12 and 13: where the touching elements' tips go, seen from above.

use super::super::run_data::{RunData, Stroke};
use super::Figure;
use super::canvas::{CAP, Pen, finger_colour, frame, line, panel, range};
use glam::{DVec2, DVec3};
use kuva::render::figure::Figure as Panels;
use kuva::render::plots::Plot;
use std::f64::consts::TAU;

/// Metres to millimetres.
const MM: f64 = 1e3;
const LEADING: f64 = 2.6;
const TOUCHING: f64 = 1.0;
const PLANNED: f64 = 1.4;

/// Fig. 12.
pub fn before_closing(data: &RunData) -> Figure {
    Figure {
        number: 12,
        title: "Tips of the touching elements in stroke 1, before closing".into(),
        caption: "From above, with close-ups of each finger's side below. In the paper's Fig. 12 \
            the tips keep to the planned straight segment (dashed) and only pass by the cap. Drawn \
            are the centres of the undeformed tips, boldest that of the element pressed hardest \
            when MOVE begins; the grey dashed circle is where a centre would be if its tip touched \
            the cap without being pressed."
            .into(),
        svg: tips_from_above(data, 12, 1),
    }
}

/// Fig. 13.
pub fn after_closing(data: &RunData) -> Figure {
    Figure {
        number: 13,
        title: "Tips of the touching elements in stroke 4, after closing".into(),
        caption: "The same views and axes as for stroke 1. In the paper's Fig. 13 every slip has \
            pressed the finger further inward, so that the straight segment has become a curve \
            closer to the cap's contour. Claims path-follows-contour and path-saturates measure \
            that here."
            .into(),
        svg: tips_from_above(data, 13, 4),
    }
}

/// All panels of one stroke; the window is the same for strokes 1 and 4.
fn tips_from_above(data: &RunData, number: u32, index: u32) -> Option<String> {
    let stroke = data.whole_stroke(index)?;
    let centre = data.cap_centre.get(stroke.moving.start)?.truncate();
    let mut overview = cap_outline(data, centre);
    let mut layouts = Vec::new();
    let mut close_ups = Vec::new();
    for finger in 0..data.fingers.len() {
        let paths = finger_paths(data, stroke, finger);
        overview.extend(finger_paths(data, stroke, finger));
        let window = close_up_window(data, finger)?;
        let mut plots = cap_outline(data, centre);
        plots.extend(paths);
        close_ups.push(plots);
        let y_label = if finger == 0 { "y (mm)" } else { "" };
        layouts.push(
            panel(window.0, window.1, "x (mm)", y_label)
                .with_equal_aspect()
                .with_ticks(4)
                .with_x_axis_min(window.0.0)
                .with_x_axis_max(window.0.1)
                .with_y_axis_min(window.1.0)
                .with_y_axis_max(window.1.1),
        );
    }
    let reach = MM * 1.35 * (data.facts.cap_radius + data.facts.feeler_tip_radius);
    let whole = |middle: f64| (MM * middle - reach, MM * middle + reach);
    let (x, y) = (whole(centre.x), whole(centre.y));
    layouts.insert(
        0,
        panel(x, y, "", "y (mm)")
            .with_equal_aspect()
            .with_y_axis_min(y.0)
            .with_y_axis_max(y.1),
    );
    let columns = close_ups.len();
    let mut structure = vec![(0..columns).collect::<Vec<_>>()];
    structure.extend((columns..2 * columns).map(|cell| vec![cell]));
    let mut plots = vec![overview];
    plots.extend(close_ups);
    let panels = Panels::new(2, columns)
        .with_structure(structure)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_spacing(6.0)
        .with_padding(6.0);
    let title = format!("Tips of the touching elements in stroke {index}, from above");
    Some(frame(number, &title, &legend(data), panels, 680.0))
}

fn legend(data: &RunData) -> Vec<(&'static str, Pen)> {
    const NAMES: [&str; 5] = ["finger 0", "finger 1", "finger 2", "finger 3", "finger 4"];
    let fingers = NAMES.iter().enumerate().take(data.fingers.len());
    let mut legend: Vec<_> = fingers
        .map(|(f, name)| (*name, Pen::solid(finger_colour(f), LEADING)))
        .collect();
    legend.extend([
        ("other touching elements", Pen::solid("#888888", TOUCHING)),
        ("planned segment", Pen::dashed("#555555", PLANNED)),
        ("cap", Pen::solid(CAP, 1.8)),
        ("cap + tip radius", Pen::dashed("#999999", 1.0)),
    ]);
    legend
}

/// The cap's contour, and the circle of a tip's centre that touches it.
fn cap_outline(data: &RunData, centre: DVec2) -> Vec<Plot> {
    let circle = |radius: f64, pen| {
        let points = (0..=240).map(|i| {
            let angle = TAU * f64::from(i) / 240.0;
            let point = centre + radius * DVec2::from_angle(angle);
            (MM * point.x, MM * point.y)
        });
        line(points, pen)
    };
    let facts = &data.facts;
    vec![
        circle(facts.cap_radius, Pen::solid(CAP, 1.8)),
        circle(
            facts.cap_radius + facts.feeler_tip_radius,
            Pen::dashed("#999999", 1.0),
        ),
    ]
}

/// A finger's paths over MOVE: the planned segment, every touching element, and, boldest, the
/// element that leads.
fn finger_paths(data: &RunData, stroke: &Stroke, finger: usize) -> Vec<Plot> {
    let columns = &data.fingers[finger];
    let mut plots = Vec::new();
    let elements = (stroke.moving.clone())
        .map(|row| columns.forces[row].len())
        .max()
        .unwrap_or(0);
    for element in 0..elements {
        let touching = |row: usize| {
            let force = columns.forces[row].get(element)?;
            (force.z > data.facts.touch_force_threshold)
                .then(|| columns.element_tips[row].get(element).copied())?
        };
        let pen = Pen::solid("#888888", TOUCHING);
        plots.extend(stretches(stroke, touching).map(|path| draw(&path, pen)));
    }
    if let Some(segment) = planned_segment(data, stroke, finger) {
        plots.push(draw(&segment, Pen::dashed("#555555", PLANNED)));
    }
    let pen = Pen::solid(finger_colour(finger), LEADING);
    let leading = columns.leading_path(stroke);
    plots.extend(leading.map(|path| draw(&path, pen)));
    plots
}

/// The unbroken stretches of a path over MOVE: broken where it has no point.
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

/// Where the tip of the element that leads would have gone had the finger kept to the planned
/// direction, over the distance that it went along that direction.
fn planned_segment(data: &RunData, stroke: &Stroke, finger: usize) -> Option<[DVec3; 2]> {
    let columns = &data.fingers[finger];
    let direction = DVec3::from(*data.facts.stroke_direction.get(finger)?);
    let start = *columns.leading_path(stroke)?.first()?;
    let path = columns.position.get(stroke.moving.clone())?;
    let travel = (*path.last()? - *path.first()?).dot(direction);
    Some([start, start + travel * direction])
}

/// Ranges of x and y (mm) around a finger's leading tips in strokes 1 and 4, of one size
/// for all fingers.
fn close_up_window(data: &RunData, finger: usize) -> Option<((f64, f64), (f64, f64))> {
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
fn tips_extent(data: &RunData, finger: usize) -> Option<((f64, f64), (f64, f64))> {
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
