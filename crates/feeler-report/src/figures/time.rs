//! Figs. 8 to 11: forces, rates and torque over time.

use super::Figure;
use super::slip_strip::slip_strip;
use crate::figures::drawing::canvas::{
    BUCKETS, CAP, MAX_SHADED, Pen, REFERENCE, SHADE, exact_panel, finger_colour, finger_legend,
    frame, line, range, thin, with_moves,
};
use crate::figures::drawing::grid::{Panel, Row, stack};
use crate::page_data::panels::{Axis, Colour, Panel as AnsweringPanel, Series};
use crate::page_data::table::of_finger;
use crate::run::data::RunData;
use crate::run::finger_columns::FingerColumns;
use kuva::render::annotations::{ReferenceLine, TextAnnotation};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use std::ops::Range;

/// Height of a panel.
const HEIGHT: f64 = 170.0;
/// Height of the time axis of the lowest panel.
const AXIS: f64 = 60.0;
/// Line width of a series.
const LINE: f64 = 1.6;
/// Label of time axes.
const TIME: &str = "Time (s)";
/// Line width of a threshold.
const THRESHOLD: f64 = 1.4;

/// Fig. 8: grasp force and torque. Torque is omitted if it was not measured (also in Figs. 9 to 11).
pub fn grasp_force_and_torque(data: &RunData) -> Figure {
    let rows = 0..data.time.len();
    let upper = Upper {
        name: "Grasp force",
        label: "Grasp force (N)",
        value: |finger, row| finger.grasp_force[row],
        column: "grasp_force",
        unit: "N",
        threshold: data.facts.grasp_force_threshold,
        threshold_name: "grasp threshold",
    };
    let title = title(data, &upper, rows.clone(), "over the run");
    let caption = if shows_torque(data, rows.clone()) {
        "Each touch-and-release stroke produces a peak of grasp force and a peak of torque. \
            The paper's Fig. 8 shows four of each: in stroke 1, torque rises while grasp force \
            stays constant; strokes 3 and 4 are nearly identical, because the cap is closed. Claims \
            four-peaks, first-stroke-torque-rises and closed-after-third quantify the agreement \
            of this run."
    } else {
        "Each touch-and-release stroke produces a peak of grasp force. The paper's Fig. 8 shows \
            four; those of strokes 3 and 4 are nearly identical, because the cap is closed."
    };
    Figure {
        panels: answering(data, &upper, None),
        svg: panels(data, 8, &title, &upper, rows, false),
        ..Figure::missing(8, title, caption)
    }
}

/// Fig. 9: shear rate and torque.
pub fn shear_rate_and_torque(data: &RunData) -> Figure {
    let (rows, upper) = (0..data.time.len(), shear_rate(data));
    let title = title(data, &upper, rows.clone(), "over the run");
    let in_step = if shows_torque(data, rows.clone()) {
        "In the paper's Fig. 9 its bumps coincide with those of the \
            torque, because the slipping element vibrates; claim bumps-in-step measures this \
            correlation. "
    } else {
        ""
    };
    let caption = format!(
        "The shear rate is the absolute time derivative of the shear force on the \
            most compressed element. {in_step}If the rate of any element exceeds the slip threshold (dashed), the finger is \
            pressed further inward. The axis is scaled to MOVE; peaks at release may \
            exceed it."
    );
    Figure {
        panels: answering(data, &upper, None),
        svg: panels(data, 9, &title, &upper, rows, false),
        ..Figure::missing(9, title, caption)
    }
}

/// Figs. 10 and 11: one stroke of Fig. 9 in detail.
pub fn stroke_in_detail(data: &RunData, number: u32, stroke: u32) -> Figure {
    let rows = data.whole_stroke(stroke).map(|s| s.rows.clone());
    let upper = shear_rate(data);
    let span = rows.clone().unwrap_or(0..data.time.len());
    let title = title(data, &upper, span, &format!("in stroke {stroke}"));
    let knows_slip = rows.as_ref().is_some_and(|rows| knows_slip(data, rows));
    let caption = match (stroke == 1, knows_slip) {
        (true, true) => [
            FIRST,
            " and, below it, when a feeler truly slipped on the cap (ground truth).",
        ],
        (true, false) => [FIRST, "."],
        (false, true) => [
            CLOSED,
            " In the strip, SLIP should coincide with true slip; claim slip-means-slip measures how often it does.",
        ],
        (false, false) => [CLOSED, ""],
    };
    Figure {
        panels: rows
            .as_ref()
            .map_or_else(Vec::new, |rows| answering(data, &upper, Some(rows))),
        svg: rows.and_then(|rows| panels(data, number, &title, &upper, rows, true)),
        ..Figure::missing(number, title, caption.concat())
    }
}

const FIRST: &str = "In the paper's Fig. 10 the cap is still loose, and the shear rate is low. The figure of stroke 4 \
    has the same vertical axes for comparison. The strip shows when each finger's SLIP was raised";
const CLOSED: &str = "In the paper's Fig. 11 the cap is locked, and the shear rate is pronounced: the elements slip \
    in bumps. Claim shear-rate-marks-closing compares this stroke with stroke 1.";

/// `true` if the true slip of a finger is known at all of these rows.
fn knows_slip(data: &RunData, rows: &Range<usize>) -> bool {
    let known = |finger: &FingerColumns| {
        rows.clone()
            .all(|row| matches!(finger.slipped.get(row), Some(Some(_))))
    };
    data.fingers.iter().any(known)
}

/// `true` if the torque is known at any of these rows.
fn shows_torque(data: &RunData, rows: Range<usize>) -> bool {
    data.known_torque(rows).next().is_some()
}

fn title(data: &RunData, upper: &Upper, rows: Range<usize>, when: &str) -> String {
    let torque = if shows_torque(data, rows) {
        " and torque"
    } else {
        ""
    };
    format!("{}{torque} {when}", upper.name)
}

fn shear_rate(data: &RunData) -> Upper {
    Upper {
        name: "Shear rate",
        label: "Shear rate (N/s)",
        value: |finger, row| finger.shear_rate[row],
        column: "shear_rate",
        unit: "N/s",
        threshold: data.facts.slip_threshold,
        threshold_name: "slip threshold",
    }
}

/// Quantity of the panel above the torque.
struct Upper {
    name: &'static str,
    label: &'static str,
    value: fn(&FingerColumns, usize) -> f64,
    column: &'static str,
    unit: &'static str,
    threshold: f64,
    threshold_name: &'static str,
}

/// Interactive version of [`panels`] over all rows, which initially shows `rows`.
fn answering(data: &RunData, upper: &Upper, rows: Option<&Range<usize>>) -> Vec<AnsweringPanel> {
    let fingers = 0..data.fingers.len();
    let finger = |finger| {
        let column = of_finger(finger, upper.column);
        Series::of_column(format!("finger {finger}"), Colour::Finger(finger), column)
    };
    let mut axis = Axis::new(upper.name, upper.unit, 1.0);
    axis.range = Some((0.0, top(data, upper)));
    let quantity = AnsweringPanel::over_time(axis, fingers.clone().map(finger).collect());
    let mut panels = vec![quantity.with_threshold(upper.threshold, upper.threshold_name)];
    if let Some(rows) = rows {
        let slips = |finger: usize| {
            let flags = of_finger(finger, "flags");
            let lane = |name, colour, bit| Series::of_bit(name, colour, flags.clone(), bit);
            let felt = lane(format!("SLIP, finger {finger}"), Colour::Finger(finger), 1);
            let known = knows_slip(data, rows);
            let truth = format!("true slip, finger {finger}");
            [felt]
                .into_iter()
                .chain(known.then(|| lane(truth, Colour::Shared, 3)))
        };
        let lanes = fingers.flat_map(slips).collect();
        panels.push(AnsweringPanel::over_time(Axis::new("Slip", "", 1.0), lanes));
    }
    if shows_torque(data, 0..data.time.len()) {
        let torque = Series::of_column("torque", Colour::Shared, "torque");
        let axis = Axis::new("Torque", "mN·m", 1e3);
        panels.push(AnsweringPanel::over_time(axis, vec![torque]));
    }
    for panel in &mut panels {
        panel.rows = rows.map(|rows| (rows.start, rows.end));
    }
    panels
}

/// Static panels over a range of rows: a quantity of each finger at the top, the torque at the bottom, and optionally
/// the slip strip between them.
fn panels(
    data: &RunData,
    number: u32,
    title: &str,
    upper: &Upper,
    rows: Range<usize>,
    with_slip: bool,
) -> Option<String> {
    let time = range(data.time.get(rows.clone())?.iter().copied())?;
    let row = |height, panel| Row {
        height,
        panels: vec![panel],
    };
    let strip = (with_slip && !data.fingers.is_empty()).then(|| {
        let (height, (plots, layout)) = slip_strip(data, rows.clone(), time);
        row(height, (plots, with_strokes(layout, data, time, None)))
    });
    let torque = torque_panel(data, rows.clone(), time);
    let has_torque = torque.is_some();
    let (plots, layout) = upper_panel(data, upper, rows, time);
    let mut stacked = Vec::new();
    if let Some(torque) = torque {
        stacked.push(row(HEIGHT, (plots, layout.with_force_margins_y(10.0, 4.0))));
        stacked.extend(strip);
        stacked.push(row(HEIGHT, torque));
    } else {
        // The lowest panel labels the time axis.
        stacked.extend(strip);
        stacked.push(row(HEIGHT + AXIS, (plots, layout.with_x_label(TIME))));
    }
    let (panels, height) = stack(stacked);
    let panels = panels.with_shared_x_all();
    let legend = legend(data, upper, has_torque);
    Some(frame(number, title, &legend, panels, height))
}

/// A quantity over time for a range of rows.
fn series(data: &RunData, rows: Range<usize>, value: impl Fn(usize) -> f64, pen: Pen) -> Plot {
    let points = rows.map(|row| (data.time[row], value(row)));
    let points: Vec<_> = points.filter(|point| point.1.is_finite()).collect();
    line(thin(&points, BUCKETS), pen)
}

fn upper_panel(data: &RunData, upper: &Upper, rows: Range<usize>, time: (f64, f64)) -> Panel {
    let fingers = (data.fingers.iter().enumerate()).map(|(f, finger)| {
        // Draw the other fingers thinner, so that identical lines remain visible.
        let pen = Pen::solid(finger_colour(f), LINE + 0.8 - 1.2 * f.min(1) as f64);
        series(data, rows.clone(), |row| (upper.value)(finger, row), pen)
    });
    let top = top(data, upper);
    let threshold = ReferenceLine::horizontal(upper.threshold)
        .with_color(REFERENCE)
        .with_stroke_width(THRESHOLD);
    let layout = exact_panel(time, (0.0, top), "", upper.label);
    let layout = with_strokes(layout, data, time, Some(top)).with_reference_line(threshold);
    (fingers.collect(), layout)
}

/// Upper end of a quantity's axis; the same in all of its figures, so that strokes can be compared.
fn top(data: &RunData, upper: &Upper) -> f64 {
    let largest = range((data.fingers.iter()).flat_map(|finger| {
        let moving = data.strokes.iter().flat_map(|stroke| stroke.moving.clone());
        moving.map(|row| (upper.value)(finger, row))
    }));
    let largest = largest.map_or(0.0, |(_, largest)| largest);
    1.25 * largest.max(upper.threshold).max(1e-3)
}

/// Torque over time for a range of rows; `None` if no torque is known.
fn torque_panel(data: &RunData, rows: Range<usize>, time: (f64, f64)) -> Option<Panel> {
    let column = data
        .torque
        .as_ref()
        .filter(|_| shows_torque(data, rows.clone()))?;
    let pen = Pen::solid(CAP, LINE);
    let torque = series(data, rows, |row| 1e3 * column[row], pen);
    let torques = range(column.iter().map(|torque| 1e3 * torque))?;
    let (low, high) = (torques.0.min(0.0), 1.08 * torques.1.max(1.0));
    let layout = exact_panel(time, (low, high), TIME, "Torque (mN·m)");
    Some((vec![torque], with_strokes(layout, data, time, None)))
}

fn legend(data: &RunData, upper: &Upper, has_torque: bool) -> Vec<(&'static str, Pen)> {
    let mut legend = finger_legend(data.fingers.len(), LINE);
    if has_torque {
        legend.push(("torque", Pen::solid(CAP, LINE)));
    }
    legend.push((upper.threshold_name, Pen::dashed(REFERENCE, THRESHOLD)));
    legend.push(("MOVE of stroke n", Pen::solid(SHADE, 14.0)));
    legend
}

/// Shades the MOVE phases within a time span, and numbers the strokes at height `top`.
fn with_strokes(layout: Layout, data: &RunData, time: (f64, f64), top: Option<f64>) -> Layout {
    let mut shown = Vec::new();
    for stroke in data.strokes.iter().filter(|s| !s.moving.is_empty()) {
        let start = data.time[stroke.moving.start].max(time.0);
        let end = data.time[stroke.moving.end - 1].min(time.1);
        if start < end {
            shown.push((stroke.index, start, end));
        }
    }
    let moves = shown.iter().map(|&(_, start, end)| (start, end));
    let layout = with_moves(layout, moves.collect());
    let Some(top) = top.filter(|_| shown.len() <= MAX_SHADED) else {
        return layout;
    };
    shown.iter().fold(layout, |layout, (index, start, end)| {
        let number = TextAnnotation::new(index.to_string(), 0.5 * (start + end), 0.88 * top);
        layout.with_annotation(number.with_font_size(15))
    })
}
