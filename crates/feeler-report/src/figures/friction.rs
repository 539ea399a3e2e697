//! Figures of a friction scan. They show the observed element of each stroke: the element with the largest F_z when the
//! stroke starts.

use super::Figure;
use super::friction_samples::{Sample, strokes};
use crate::figures::drawing::canvas::{
    BUCKETS, CAP, Pen, REFERENCE, Style, exact_panel, finger_colour, line, range, thin, with_moves,
};
use crate::figures::drawing::sheet::{Drawing, column};
use crate::measures::series::mean;
use crate::run::data::RunData;
use feeler_record::FindingName;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use std::f64::consts::TAU;

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

/// Fig. 1: forces on the observed element.
pub fn forces(data: &RunData) -> Figure {
    let title = "Forces on the observed element";
    let caption = "The load is controlled over all touching elements, so the share of one element may change as the \
            fingertip rolls. Friction is positive if it opposes the first stroke; its teeth are slips. \
            The evaluated strokes are shaded: the first stroke only removes the shear left from pressing.";
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

/// Fig. 2: ratio of friction to normal force.
pub fn ratio(data: &RunData) -> Figure {
    let title = "Ratio of friction to normal force";
    let caption = "While the element sticks, the ratio rises to the static coefficient; when it slips, it falls to the \
            kinetic coefficient. Dashed lines are the measured coefficients. The measured tilt along the slide is compensated; \
            tilt across the slide is not, but has little effect.";
    Figure::drawn(2, title, caption, ratio_over_time(data, title))
}

fn ratio_over_time(data: &RunData, title: &str) -> Option<Drawing> {
    let strokes = strokes(data)?;
    let time = range(strokes.iter().flatten().map(|s| s.time))?;
    let top = 1.15 * range(strokes.iter().flatten().map(|s| s.ratio()))?.1;
    let pen = Pen::solid(finger_colour(0), LINE);
    let mut plots = over_time(&strokes, |s| s.ratio(), pen);
    let mut legend = vec![("friction / normal force", pen)];
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
        (FindingName::StaticFriction, "measured static", STATIC),
        (FindingName::KineticFriction, "measured kinetic", KINETIC),
    ]
}

/// Fig. 3: path of the tangential force.
pub fn path(data: &RunData) -> Figure {
    let title = "Path of the tangential force";
    let caption = "Friction along and across the slide, divided by the normal force: the friction cone in top view. Forces stay \
            within the static circle. The offset of the path from the origin shows the tilt of the specimen \
            across the slide; the circles are centred on it.";
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
    let layout = exact_panel(x, y, "Along the slide", "Across").with_equal_aspect();
    Some(column((3, title), &legend, vec![(plots, layout)], 460.0))
}

/// Fig. 4: measured and true coefficients. `truth` contains the static and the kinetic coefficient.
pub fn found_and_true(data: &RunData, truth: [Option<f64>; 2]) -> Figure {
    let title = "Measured and true coefficients";
    let caption = "Crosses on the bold line are exact; the thin lines mark an error of 5 %.";
    Figure::drawn(4, title, caption, crosses(data, truth, title))
}

fn crosses(data: &RunData, truth: [Option<f64>; 2], title: &str) -> Option<Drawing> {
    let top = 1.25 * range(truth.into_iter().flatten())?.1;
    let (same, off) = (Pen::solid(REFERENCE, 1.4), Pen::solid("#999999", 0.8));
    let ray = |slope: f64, pen| line([(0.0, 0.0), (top, slope * top)], pen);
    let mut plots = vec![ray(1.0, same), ray(0.95, off), ray(1.05, off)];
    let mut legend = vec![("exact", same), ("5 % error", off)];
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
        legend.push((words.trim_start_matches("measured "), pen));
    }
    let layout = exact_panel((0.0, top), (0.0, top), "True", "Measured").with_equal_aspect();
    Some(column((4, title), &legend, vec![(plots, layout)], 440.0))
}

/// One line per stroke, so that strokes are not connected.
fn over_time(strokes: &[Vec<Sample>], value: fn(&Sample) -> f64, pen: Pen) -> Vec<Plot> {
    let series = |samples: &Vec<Sample>| {
        let points: Vec<_> = samples.iter().map(|s| (s.time, value(s))).collect();
        line(thin(&points, BUCKETS), pen)
    };
    strokes.iter().map(series).collect()
}

/// A panel over time with the evaluated strokes shaded.
fn time_panel(
    data: &RunData,
    time: (f64, f64),
    y: (f64, f64),
    x_label: &str,
    y_label: &str,
) -> Layout {
    let counting = data
        .strokes
        .iter()
        .filter(|s| s.index > 1 && !s.moving.is_empty());
    let moves = counting.map(|stroke| {
        let start = data.time[stroke.moving.start];
        let end = data.time[stroke.moving.end - 1];
        // Leave a gap between consecutive strokes.
        (start + 0.01 * (end - start), end)
    });
    with_moves(exact_panel(time, y, x_label, y_label), moves.collect())
}
