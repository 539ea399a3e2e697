//! Figs. 12 and 13: where the fingertips go in a stroke, and whether that is along the cap.

use super::super::page_data::panels::{Axis, Colour, Panel as AnsweringPanel, Points, Series};
use super::super::run_data::{RunData, Stroke};
use super::Figure;
use super::canvas::{Pen, SHADE, finger_colour, finger_legend, frame, line, panel, range};
use super::from_above::{
    ARC, BOLD, CONTOUR, JUST_TOUCHING, MM, PLANNED, TOUCHING, cap_above, close_ups, overview,
};
use super::grid::{Panel, rows, stack};
use super::unrolled::{Step, Unrolled};
use glam::DVec2;
use kuva::render::annotations::ShadedRegion;
use kuva::render::layout::Layout;
use std::f64::consts::TAU;

/// Height of a row of close-ups of tips, and of paths laid out.
const HEIGHTS: (f64, f64) = (235.0, 225.0);

/// Fig. 12; without cap and arc where nothing tells where the cap is, as Fig. 13.
pub fn before_closing(data: &RunData) -> Figure {
    let arc = knows_arc(data, 1);
    let close_up = match shows_cap(data, 1) {
        true => " on the grey circle a tip touches the cap without being pressed.",
        false => " where the cap is was not measured.",
    };
    let above = match shows_cap(data, 1) {
        true => "bold beside the cap the domes' centres, bold at the cap the tip",
        false => "bold on the outside the domes' centres, bold on the inside the tip",
    };
    let laid_out = match arc {
        true => {
            "; a finger that follows the cap keeps to the dotted arc about the cap's axis. Line \
            and arc begin at a quarter of the travel, where the shade begins: the grip has built up."
        }
        false => {
            ". The line begins at a quarter of the travel, where the shade begins: the grip has built up."
        }
    };
    Figure {
        number: 12,
        title: "Paths of the fingertips in stroke 1, before closing".into(),
        caption: format!(
            "In the paper's Fig. 12 the cap is loose, and the tips of the touching elements keep to the straight segment \
            that was planned (dashed) and only pass by the cap. Top: from above, {above} of the element that is pressed hardest when MOVE begins. Middle: the tips close up;{close_up} \
            Bottom: how far each dome's centre is from its \
            planned line, much enlarged{laid_out}"
        ),
        panels: from_above(data, 1),
        columns: 1,
        svg: paths(data, 12, 1),
    }
}

/// Fig. 13.
pub fn after_closing(data: &RunData) -> Figure {
    let compare = match knows_arc(data, 4) {
        true => "the dotted arc about the cap's axis and with the dashed line that was planned",
        false => "the dashed line that was planned",
    };
    let claims = match knows_arc(data, 4) {
        true => "Claims path-follows-contour, path-is-curved and path-saturates measure that.",
        false => "Claim path-saturates compares it with stroke 3.",
    };
    Figure {
        number: 13,
        title: "Paths of the fingertips in stroke 4, after closing".into(),
        caption: format!(
            "The same views and axes as for stroke 1. In the paper's Fig. 13 every slip has \
            pressed the finger further inward, so that the straight segment has become a curve \
            closer to the cap's contour. At the bottom, compare the bold path with {compare}; a straight path that leaves the line is tilted, not curved. {claims}"
        ),
        panels: from_above(data, 4),
        columns: 1,
        svg: paths(data, 13, 4),
    }
}

/// The domes' centres from above, with the cap, and how they leave the planned line.
fn from_above(data: &RunData, index: u32) -> Vec<AnsweringPanel> {
    let Some(stroke) = data.whole_stroke(index) else {
        return Vec::new();
    };
    let (mut plan, mut bends) = (Vec::new(), Vec::new());
    for finger in 0..data.fingers.len() {
        let Some(unrolled) = Unrolled::new(data, stroke, finger) else {
            continue;
        };
        let first = stroke.moving.start;
        let points = |of: fn(&Step) -> (f64, f64)| {
            let steps = unrolled.steps.iter().map(of).enumerate();
            Points::of_rows(steps.map(|(step, (x, y))| (first + step, x, y)))
        };
        let own = |of| {
            let name = format!("finger {finger}");
            Series::of_points(name, Colour::Finger(finger), points(of))
        };
        let other = |name: &str, of| {
            let name = format!("{name}, finger {finger}");
            Series::of_points(name, Colour::Reference, points(of)).dashed()
        };
        plan.push(own(|step| (step.centre.x, step.centre.y)));
        plan.push(other("planned line", |step| {
            (step.on_line.x, step.on_line.y)
        }));
        bends.push(own(|step| (step.travel, step.path)));
        if unrolled.has_arc() {
            bends.push(other("arc", |step| (step.travel, step.arc)));
        }
    }
    if let Some(centre) = cap_above(data, stroke) {
        let point = |k: u32| {
            let side = DVec2::from_angle(TAU * f64::from(k) / 120.0);
            let point = centre + data.facts.cap_radius * side;
            (point.x, point.y)
        };
        let cap = Points::new((0..=120).map(point));
        plan.push(Series::of_points("cap", Colour::Shared, cap));
    }
    let mm = |label: &str| Axis::new(label, "mm", MM);
    let mut plan = AnsweringPanel::of(mm("x"), mm("y"), plan);
    plan.equal = true;
    let bends = AnsweringPanel::of(mm("Travel"), mm("Offset from the planned line"), bends);
    vec![plan, bends]
}

/// Whether the cap is to be seen in the figure of a stroke.
fn shows_cap(data: &RunData, index: u32) -> bool {
    let stroke = data.whole_stroke(index);
    stroke.is_some_and(|stroke| cap_above(data, stroke).is_some())
}

/// Whether any finger's arc is.
fn knows_arc(data: &RunData, index: u32) -> bool {
    let arc =
        |stroke: &Stroke, finger| Unrolled::new(data, stroke, finger).is_some_and(|u| u.has_arc());
    let stroke = data.whole_stroke(index);
    stroke.is_some_and(|stroke| (0..data.fingers.len()).any(|finger| arc(stroke, finger)))
}

/// All panels of one stroke; the axes are the same for strokes 1 and 4.
fn paths(data: &RunData, number: u32, index: u32) -> Option<String> {
    let stroke = data.whole_stroke(index)?;
    let mut panels = vec![overview(data, stroke)?];
    panels.extend(rows(HEIGHTS.0, close_ups(data, stroke)?));
    panels.extend(rows(HEIGHTS.1, bends(data, stroke)));
    let (panels, height) = stack(panels);
    let title = format!("Paths of the fingertips in stroke {index}, from above and laid out");
    let legend = legend(data, knows_arc(data, index), shows_cap(data, index));
    Some(frame(number, &title, &legend, panels, height))
}

fn legend(data: &RunData, arc: bool, cap: bool) -> Vec<(&'static str, Pen)> {
    let tip = cap && data.facts.feeler_tip_radius > 0.0;
    let mut legend = finger_legend(data.fingers.len(), BOLD);
    legend.extend(
        [
            (true, "planned line", PLANNED),
            (arc, "arc about the cap's axis", ARC),
            (true, "other touching tips", TOUCHING),
            (cap, "cap", CONTOUR),
            (tip, "cap + tip radius", JUST_TOUCHING),
            (true, "window of the claims", Pen::solid(SHADE, 14.0)),
        ]
        .into_iter()
        .filter_map(|(drawn, name, pen)| drawn.then_some((name, pen))),
    );
    legend
}

/// Each finger's dome's centre: its offset from the planned line over the travel.
fn bends(data: &RunData, stroke: &Stroke) -> Vec<Panel> {
    let Some((x, y)) = bend_window(data) else {
        return Vec::new();
    };
    let bend = |finger: usize| {
        let y_label = if finger == 0 {
            "towards the cap (mm)"
        } else {
            ""
        };
        let layout = panel(x, y, "travel (mm)", y_label)
            .with_ticks(4)
            .with_x_axis_min(x.0)
            .with_x_axis_max(x.1)
            .with_y_axis_min(y.0)
            .with_y_axis_max(y.1);
        let Some(unrolled) = Unrolled::new(data, stroke, finger) else {
            return (Vec::new(), layout);
        };
        let curve = |offset: fn(&Step) -> f64, pen| {
            let steps = unrolled.steps.iter();
            line(steps.map(|step| (MM * step.travel, MM * offset(step))), pen)
        };
        let mut plots = vec![
            curve(|step| step.path, Pen::solid(finger_colour(finger), BOLD)),
            curve(|_| 0.0, PLANNED),
        ];
        plots.extend(unrolled.has_arc().then(|| curve(|step| step.arc, ARC)));
        (plots, with_window(layout, unrolled.window))
    };
    (0..data.fingers.len()).map(bend).collect()
}

/// Shades the travel (m) that the claims look at.
pub fn with_window(layout: Layout, window: (f64, f64)) -> Layout {
    let shade = ShadedRegion::vertical(MM * window.0, MM * window.1);
    layout.with_shaded_region(shade.with_color(SHADE).with_opacity(0.55))
}

/// Ranges of travel and offset (mm) of all fingers in strokes 1 and 4.
fn bend_window(data: &RunData) -> Option<((f64, f64), (f64, f64))> {
    let strokes = [1, 4].iter().filter_map(|&index| data.whole_stroke(index));
    let steps: Vec<Step> = strokes
        .flat_map(|stroke| {
            let fingers = 0..data.fingers.len();
            fingers.filter_map(|finger| Unrolled::new(data, stroke, finger))
        })
        .flat_map(|unrolled| unrolled.steps)
        .collect();
    let (_, end) = range(steps.iter().map(|step| MM * step.travel))?;
    let (low, high) = range(steps.iter().flat_map(|s| [MM * s.path, MM * s.arc, 0.0]))?;
    let margin = 0.06 * (high - low);
    Some(((0.0, end), (low - margin, high + margin)))
}
