//! The figures of a friction scan, all of the element that each stroke looks at: the one of largest F_z when
//! it begins.

use super::Figure;
use super::canvas::{
    CAP, MOST_SHADED, Pen, REFERENCE, SHADE, Style, finger_colour, line, panel, range, thin,
};
use super::drawing::{Drawing, column};
use super::friction_samples::{Sample, strokes};
use crate::run_data::RunData;
use crate::series::mean;
use feeler_record::FindingName;
use kuva::render::annotations::ShadedRegion;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use std::f64::consts::TAU;

const BUCKETS: usize = 480;
/// Left and right of panels over time, so that their times stand one above the other.
const MARGINS: (f64, f64) = (64.0, 20.0);
const LINE: f64 = 1.6;
const STATIC: Pen = Pen {
    colour: "#D55E00",
    width: 1.8,
    style: Style::Dashed,
};
const KINETIC: Pen = Pen {
    colour: "#009E73",
    width: 1.8,
    style: Style::Dashed,
};

/// Fig. 1.
pub fn forces(data: &RunData) -> Figure {
    let title = "Forces of the element that is looked at";
    let caption = "The load is regulated over all elements that touch, so that the share of one may change as the \
            fingertip rolls. Friction is positive where it acts against the first stroke; its teeth are slips. \
            Shaded are the strokes that count: the first wipes away what shear the pressing left.";
    Figure::drawn(1, title, caption, forces_over_time(data, title))
}

fn forces_over_time(data: &RunData, title: &str) -> Option<Drawing> {
    let strokes = strokes(data)?;
    let (normal, friction) = (Pen::solid(CAP, LINE), Pen::solid(finger_colour(0), LINE));
    let plots = |value: fn(&Sample) -> f64, pen: Pen| over_time(&strokes, value, pen);
    let time = range(strokes.iter().flatten().map(|s| s.time))?;
    let top = 1.1 * range(strokes.iter().flatten().map(|s| s.normal))?.1;
    let ends = range(strokes.iter().flatten().map(|s| s.friction))?;
    let upper = time_panel(data, time, (0.0, top), "", "Normal force (N)");
    let lower = time_panel(
        data,
        time,
        (1.1 * ends.0, 1.1 * ends.1),
        "Time (s)",
        "Friction (N)",
    );
    let panels = vec![
        (plots(|s| s.normal, normal), upper),
        (plots(|s| s.friction, friction), lower),
    ];
    let legend = [("normal force", normal), ("friction", friction)];
    Some(column((1, title), &legend, panels, 380.0))
}

/// Fig. 2.
pub fn ratio(data: &RunData) -> Figure {
    let title = "Friction by normal force";
    let caption = "While the element sticks, the ratio rises to the static coefficient; when it slips, it falls to the \
            kinetic one. Dashed is what the task found. The tilt that it found is taken out; what is tilted across \
            the slide is not, and does not matter much.";
    Figure::drawn(2, title, caption, ratio_over_time(data, title))
}

fn ratio_over_time(data: &RunData, title: &str) -> Option<Drawing> {
    let strokes = strokes(data)?;
    let time = range(strokes.iter().flatten().map(|s| s.time))?;
    let top = 1.15 * range(strokes.iter().flatten().map(|s| s.ratio()))?.1;
    let pen = Pen::solid(finger_colour(0), LINE);
    let mut plots = over_time(&strokes, |s| s.ratio(), pen);
    let mut legend = vec![("friction by normal force", pen)];
    for (name, words, pen) in found_lines() {
        if let Some(&value) = data.findings.get(&name) {
            plots.push(line([(time.0, value), (time.1, value)], pen));
            legend.push((words, pen));
        }
    }
    let layout = time_panel(data, time, (0.0, top), "Time (s)", "Ratio");
    Some(column((2, title), &legend, vec![(plots, layout)], 300.0))
}

fn found_lines() -> [(FindingName, &'static str, Pen); 2] {
    [
        (FindingName::StaticFriction, "found static", STATIC),
        (FindingName::KineticFriction, "found kinetic", KINETIC),
    ]
}

/// Fig. 3.
pub fn path(data: &RunData) -> Figure {
    let title = "Path of the force in the tangential plane";
    let caption = "Friction along and across the slide, both by normal force: the friction cone from above. Forces stay \
            within the static circle. A path that does not pass through the middle shows how the specimen is tilted \
            across the slide; the circles are drawn around it.";
    Figure::drawn(3, title, caption, tangential_path(data, title))
}

fn tangential_path(data: &RunData, title: &str) -> Option<Drawing> {
    let strokes = strokes(data)?;
    let counting = strokes.get(1..)?.iter().flatten();
    let across = mean(counting.map(|s| s.lateral / s.normal))?;
    let pen = Pen::solid(finger_colour(0), 1.0);
    let mut plots: Vec<Plot> = (strokes.iter())
        .map(|samples| {
            let points = samples
                .iter()
                .map(|s| (s.friction / s.normal, s.lateral / s.normal));
            line(points, pen)
        })
        .collect();
    let mut legend = vec![("force on the element", pen)];
    let ratios = strokes.iter().flatten().map(|s| s.ratio());
    let mut reach = range(ratios)?.1;
    for (name, words, pen) in found_lines() {
        if let Some(&radius) = data.findings.get(&name) {
            let circle = (0..=240).map(|i| (TAU * f64::from(i) / 240.0).sin_cos());
            plots.push(line(
                circle.map(|(y, x)| (radius * x, across + radius * y)),
                pen,
            ));
            legend.push((words, pen));
            reach = reach.max(radius);
        }
    }
    let reach = 1.15 * reach;
    let (x, y) = ((-reach, reach), (across - reach, across + reach));
    let layout = panel(x, y, "Along the slide", "Across")
        .with_equal_aspect()
        .with_x_axis_min(x.0)
        .with_x_axis_max(x.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1);
    Some(column((3, title), &legend, vec![(plots, layout)], 460.0))
}

/// Fig. 4. `truth`: static and kinetic coefficient.
pub fn found_and_true(data: &RunData, truth: [Option<f64>; 2]) -> Figure {
    let title = "Found against true";
    let caption =
        "A cross on the line is a coefficient that was found as it is; the thin lines are 5 % off.";
    Figure::drawn(4, title, caption, crosses(data, truth, title))
}

fn crosses(data: &RunData, truth: [Option<f64>; 2], title: &str) -> Option<Drawing> {
    let top = 1.25 * range(truth.into_iter().flatten())?.1;
    let (same, off) = (Pen::solid(REFERENCE, 1.4), Pen::solid("#999999", 0.8));
    let ray = |slope: f64, pen| line([(0.0, 0.0), (top, slope * top)], pen);
    let mut plots = vec![ray(1.0, same), ray(0.95, off), ray(1.05, off)];
    let mut legend = vec![("found as it is", same), ("5 % off", off)];
    for ((name, words, pen), truth) in found_lines().into_iter().zip(truth) {
        let Some((&found, truth)) = data.findings.get(&name).zip(truth) else {
            continue;
        };
        let pen = Pen {
            style: Style::Solid,
            ..pen
        };
        let arm = 0.03 * top;
        plots.push(line([(truth - arm, found), (truth + arm, found)], pen));
        plots.push(line([(truth, found - arm), (truth, found + arm)], pen));
        legend.push((words.trim_start_matches("found "), pen));
    }
    let layout = panel((0.0, top), (0.0, top), "True", "Found")
        .with_equal_aspect()
        .with_x_axis_min(0.0)
        .with_x_axis_max(top)
        .with_y_axis_min(0.0)
        .with_y_axis_max(top);
    Some(column((4, title), &legend, vec![(plots, layout)], 440.0))
}

/// A line per stroke, so that nothing joins one to the next.
fn over_time(strokes: &[Vec<Sample>], value: fn(&Sample) -> f64, pen: Pen) -> Vec<Plot> {
    let series = |samples: &Vec<Sample>| {
        let points: Vec<_> = samples.iter().map(|s| (s.time, value(s))).collect();
        line(thin(&points, BUCKETS), pen)
    };
    strokes.iter().map(series).collect()
}

/// A panel over time with the strokes that count shaded.
fn time_panel(
    data: &RunData,
    time: (f64, f64),
    y: (f64, f64),
    x_label: &str,
    y_label: &str,
) -> Layout {
    let layout = panel(time, y, x_label, y_label)
        .with_x_axis_min(time.0)
        .with_x_axis_max(time.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1)
        .with_force_margins(MARGINS.0, MARGINS.1);
    let counting = data
        .strokes
        .iter()
        .filter(|s| s.index > 1 && !s.moving.is_empty());
    if counting.clone().count() > MOST_SHADED {
        return layout;
    }
    counting.fold(layout, |layout, stroke| {
        let start = data.time[stroke.moving.start];
        let end = data.time[stroke.moving.end - 1];
        // A gap between strokes that follow each other at once.
        let shade = ShadedRegion::vertical(start + 0.01 * (end - start), end);
        layout.with_shaded_region(shade.with_color(SHADE).with_opacity(0.55))
    })
}
