//! Figs. 12 and 13: paths of the fingertips in a stroke, compared with the cap's contour.

use super::Figure;
use super::from_above::{
    ARC, BOLD, CONTOUR, JUST_TOUCHING, PLANNED, TOUCHING, cap_above, close_ups, overview,
};
use super::unrolled::{Step, Unrolled};
use crate::figures::drawing::canvas::{
    Pen, SHADE, exact_panel, finger_colour, finger_legend, frame, line, range, shaded,
};
use crate::figures::drawing::grid::{Panel, rows, stack};
use crate::measures::paths::MM;
use crate::page_data::panels::{Axis, Colour, Panel as AnsweringPanel, Points, Series};
use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use glam::DVec2;
use kuva::render::layout::Layout;
use std::f64::consts::TAU;

/// Row heights of the tip close-ups, and of the unrolled paths.
const HEIGHTS: (f64, f64) = (235.0, 225.0);

/// Fig. 12: paths before closing. Cap and arc are omitted if the cap's position is unknown (also in Fig. 13).
pub fn before_closing(data: &RunData) -> Figure {
    let arc = knows_arc(data, 1);
    let close_up = match shows_cap(data, 1) {
        true => " a tip on the gray circle touches the cap without force.",
        false => " the cap's position was not measured.",
    };
    let above = match shows_cap(data, 1) {
        true => "the outer bold lines are the dome centres, the bold lines at the cap are the tips",
        false => "the outer bold lines are the dome centres, the inner bold lines are the tips",
    };
    let laid_out = match arc {
        true => {
            "; a finger that follows the cap stays on the dotted arc about the cap's axis. Line \
            and arc start at a quarter of the travel, where the shading starts, because the grip has built up by then."
        }
        false => {
            ". The line starts at a quarter of the travel, where the shading starts, because the grip has built up by then."
        }
    };
    let title = "Paths of the fingertips in stroke 1, before closing";
    let caption = format!(
        "In the paper's Fig. 12 the cap is loose; the tips of the touching elements follow the planned straight segment \
            (dashed) and only pass by the cap. Top: top view; {above} of the most compressed elements when MOVE starts. Middle: close-up of the tips;{close_up} \
            Bottom: offset of each dome centre from its \
            planned line, magnified{laid_out}"
    );
    Figure {
        panels: from_above(data, 1),
        svg: paths(data, 12, 1),
        ..Figure::missing(12, title, caption)
    }
}

/// Fig. 13: paths after closing.
pub fn after_closing(data: &RunData) -> Figure {
    let compare = match knows_arc(data, 4) {
        true => "the dotted arc about the cap's axis and with the dashed planned line",
        false => "the dashed planned line",
    };
    let claims = match knows_arc(data, 4) {
        true => "Claims path-follows-contour, path-is-curved and path-saturates measure this.",
        false => "Claim path-saturates compares it with stroke 3.",
    };
    let title = "Paths of the fingertips in stroke 4, after closing";
    let caption = format!(
        "Same views and axes as for stroke 1. In the paper's Fig. 13 each slip has \
            pressed the finger further inward, so that the straight segment has become a curve \
            closer to the cap's contour. At the bottom, compare the bold path with {compare}; a straight path that leaves the line is tilted, not curved. {claims}"
    );
    Figure {
        panels: from_above(data, 4),
        svg: paths(data, 13, 4),
        ..Figure::missing(13, title, caption)
    }
}

/// Interactive panels: top view of the dome centres with the cap, and their offset from the planned line.
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

/// `true` if the figure of a stroke shows the cap.
fn shows_cap(data: &RunData, index: u32) -> bool {
    let stroke = data.whole_stroke(index);
    stroke.is_some_and(|stroke| cap_above(data, stroke).is_some())
}

/// `true` if the arc of any finger is known.
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
    let title = format!("Paths of the fingertips in stroke {index}, top view and unrolled");
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
            (true, "evaluation window", Pen::solid(SHADE, 14.0)),
        ]
        .into_iter()
        .filter_map(|(drawn, name, pen)| drawn.then_some((name, pen))),
    );
    legend
}

/// Offset of each finger's dome centre from the planned line, over the travel.
fn bends(data: &RunData, stroke: &Stroke) -> Vec<Panel> {
    let Some((x, y)) = bend_window(data) else {
        return Vec::new();
    };
    let bend = |finger: usize| {
        let y_label = if finger == 0 {
            "offset to cap (mm)"
        } else {
            ""
        };
        let layout = exact_panel(x, y, "travel (mm)", y_label).with_ticks(4);
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

/// Shades the travel (m) evaluated by the claims.
pub fn with_window(layout: Layout, window: (f64, f64)) -> Layout {
    shaded(layout, [(MM * window.0, MM * window.1)])
}

/// Ranges of travel and offset (mm) over all fingers in strokes 1 and 4.
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
