//! Fig. 14: distance of each dome centre from the cap's axis over the travel, for every stroke.

use super::Figure;
use super::from_above::PLANNED;
use super::paths::with_window;
use super::unrolled::{Step, Unrolled};
use crate::figures::drawing::canvas::{Pen, SHADE, exact_panel, frame, line, range, stroke_colour};
use crate::figures::drawing::grid::{Panel, rows, stack};
use crate::measures::paths::MM;
use crate::page_data::panels::{Axis, Colour, Panel as AnsweringPanel, Points, Series};
use crate::run::data::RunData;
use crate::run::stroke::Stroke;

/// Height of a row of panels.
const HEIGHT: f64 = 270.0;
/// Line width of the first stroke, and its increase up to the last stroke.
const LINE: (f64, f64) = (1.4, 1.2);

/// Fig. 14, which has no counterpart in the paper.
pub fn over_travel(data: &RunData) -> Figure {
    let title =
        "Distance R of the dome centres from the cap's axis, over the travel of each stroke";
    let caption = "A finger that follows the cap keeps its distance from the axis, so its line is level. A straight path \
            (dashed, for the last stroke) approaches the axis until it is level with it, and then recedes. R₀ is R where \
            the shading starts, at 25 % of the travel, when the grip has built up; it ends at 98 %, when the finger starts to brake. \
            The paper has no such figure; claim path-follows-contour measures this quantity.";
    Figure {
        panels: answering(data),
        svg: radius(data),
        ..Figure::missing(14, title, caption)
    }
}

/// One interactive panel per finger, with all strokes.
fn answering(data: &RunData) -> Vec<AnsweringPanel> {
    let strokes = strokes(data);
    let last = strokes.len().saturating_sub(1);
    let panel = |finger: usize| {
        let curves = strokes.iter().enumerate().filter_map(|(place, stroke)| {
            let path = Unrolled::new(data, stroke, finger)?;
            let steps = path.steps.iter().enumerate();
            let rows = steps.map(|(k, step)| (stroke.moving.start + k, step.travel, step.radius));
            let colour = if place == last {
                Colour::Finger(finger)
            } else {
                Colour::Background
            };
            let name = format!("stroke {}", stroke.index);
            Some(Series::of_points(name, colour, Points::of_rows(rows)))
        });
        let mm = |label: String| Axis::new(label, "mm", MM);
        let y = mm(format!("R − R₀, finger {finger}"));
        AnsweringPanel::of(mm("Travel".into()), y, curves.collect())
    };
    (0..data.fingers.len()).map(panel).collect()
}

/// Complete strokes with a known cap position.
fn strokes(data: &RunData) -> Vec<&Stroke> {
    let centre = data.cap.as_ref().map(|cap| &cap.centre);
    let whole = data
        .strokes
        .iter()
        .filter(|stroke| stroke.whole && !stroke.moving.is_empty());
    let known = whole.filter(|stroke| {
        let centre = centre.and_then(|centre| centre.get(stroke.moving.clone()));
        centre.is_some_and(|centre| centre.iter().any(|c| c.is_finite()))
    });
    known.collect()
}

fn radius(data: &RunData) -> Option<String> {
    let strokes = strokes(data);
    let unrolled: Vec<Vec<_>> = (0..data.fingers.len())
        .map(|finger| {
            let paths = strokes.iter().enumerate();
            paths
                .filter_map(|(k, stroke)| Some((k, Unrolled::new(data, stroke, finger)?)))
                .collect()
        })
        .collect();
    let window = window(unrolled.iter().flatten().map(|(_, path)| path))?;
    let panels = unrolled.iter().enumerate();
    let panels = panels.map(|(finger, paths)| radius_panel(finger, paths, strokes.len(), window));
    let (panels, height) = stack(rows(HEIGHT, panels.collect()));
    let title = "Distance of the dome centres from the cap's axis over the travel of each stroke";
    Some(frame(14, title, &legend(&strokes), panels, height))
}

fn pen(place: usize, strokes: usize) -> Pen {
    let share = place as f64 / strokes.saturating_sub(1).max(1) as f64;
    Pen::solid(stroke_colour(place, strokes), LINE.0 + LINE.1 * share)
}

fn radius_panel(
    finger: usize,
    paths: &[(usize, Unrolled)],
    strokes: usize,
    (x, y): ((f64, f64), (f64, f64)),
) -> Panel {
    let curve = |path: &Unrolled, radius: fn(&Step) -> f64, pen| {
        let steps = path.steps.iter();
        line(steps.map(|step| (MM * step.travel, MM * radius(step))), pen)
    };
    let mut plots: Vec<_> = (paths.iter())
        .map(|(place, path)| curve(path, |step| step.radius, pen(*place, strokes)))
        .collect();
    let y_label = if finger == 0 { "R − R₀ (mm)" } else { "" };
    let layout = exact_panel(x, y, "travel (mm)", y_label)
        .with_title(format!("finger {finger}"))
        .with_title_size(14)
        .with_ticks(4);
    let Some((_, last)) = paths.last() else {
        return (plots, layout);
    };
    plots.push(curve(last, |step| step.line_radius, PLANNED));
    (plots, with_window(layout, last.window))
}

fn legend(strokes: &[&Stroke]) -> Vec<(&'static str, Pen)> {
    const NAMES: [&str; 8] = [
        "stroke 1", "stroke 2", "stroke 3", "stroke 4", "stroke 5", "stroke 6", "stroke 7",
        "stroke 8",
    ];
    let places = strokes.iter().enumerate();
    let mut legend: Vec<_> = places
        .filter_map(|(place, stroke)| {
            let name = NAMES.get((stroke.index as usize).checked_sub(1)?)?;
            Some((*name, pen(place, strokes.len())))
        })
        .collect();
    legend.push(("planned line", PLANNED));
    legend.push(("evaluation window", Pen::solid(SHADE, 14.0)));
    legend
}

/// Ranges of travel and R (mm), the same for all fingers.
fn window<'a>(paths: impl Iterator<Item = &'a Unrolled>) -> Option<((f64, f64), (f64, f64))> {
    let steps: Vec<_> = paths.flat_map(|path| &path.steps).collect();
    let (_, end) = range(steps.iter().map(|step| MM * step.travel))?;
    let (low, high) = range((steps.iter()).flat_map(|s| [MM * s.radius, MM * s.line_radius]))?;
    let margin = 0.06 * (high - low);
    Some(((0.0, end), (low - margin, high + margin)))
}
