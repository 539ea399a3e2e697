//! Figs. 8 to 11: forces, rates and torque against time.

use super::super::run_data::{FingerColumns, RunData};
use super::Figure;
use super::canvas::{CAP, Pen, SHADE, finger_colour, frame, line, panel, range, thin};
use kuva::render::annotations::{ReferenceLine, ShadedRegion, TextAnnotation};
use kuva::render::figure::Figure as Panels;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use std::ops::Range;

/// Pairs of points that a series is thinned to.
const BUCKETS: usize = 480;
/// Left and right of both panels, so that their times stand one above the other.
const MARGINS: (f64, f64) = (64.0, 20.0);
/// Width of a series' line.
const LINE: f64 = 1.6;
/// Width of a threshold's line.
const THRESHOLD: f64 = 1.4;

/// Fig. 8.
pub fn grasp_force_and_torque(data: &RunData) -> Figure {
    let title = "Grasp force and torque over the run";
    let upper = Upper {
        label: "Grasp force (N)",
        value: |finger, row| finger.grasp_force[row],
        threshold: data.facts.grasp_force_threshold,
        threshold_name: "grasp threshold",
    };
    Figure {
        number: 8,
        title: title.into(),
        caption: "Each touch-and-release stroke makes a heap of grasp force and a heap of torque. In \
            the paper's Fig. 8 there are four of each; in stroke 1 torque rises while grasp force \
            stays level, and strokes 3 and 4 are almost the same, because the cap is closed. Claims \
            four-heaps, first-stroke-torque-rises and closed-after-third say how far this run \
            agrees."
            .into(),
        svg: two_panels(data, 8, title, &upper, 0..data.time.len()),
    }
}

/// Fig. 9.
pub fn shear_rate_and_torque(data: &RunData) -> Figure {
    let title = "Shear rate and torque over the run";
    Figure {
        number: 9,
        title: title.into(),
        caption: "The shear rate is the absolute time derivative of the shearing force on the \
            element that is pressed hardest. In the paper's Fig. 9 its bumps come in step with the \
            torque's, because the slipping element trembles; claim bumps-in-step measures that \
            here. Where the rate of any element exceeds the slip threshold (dashed), the finger is \
            pressed further inward. The axis is scaled to MOVE; peaks where the fingers detach may \
            leave it."
            .into(),
        svg: two_panels(data, 9, title, &shear_rate(data), 0..data.time.len()),
    }
}

/// Figs. 10 and 11: one stroke of Fig. 9 in detail.
pub fn stroke_in_detail(data: &RunData, number: u32, stroke: u32) -> Figure {
    let title = format!("Shear rate and torque in stroke {stroke}");
    let caption = if stroke == 1 {
        "In the paper's Fig. 10 the cap is still loose, and no marked shear rate occurs. Compare \
         with the figure of stroke 4, which has the same vertical axes."
    } else {
        "In the paper's Fig. 11 the cap is locked, and the shear rate is marked: the elements slip \
         in bumps. Claim shear-rate-marks-closing compares this stroke with stroke 1."
    };
    let rows = data.whole_stroke(stroke).map(|s| s.rows.clone());
    Figure {
        number,
        svg: rows.and_then(|rows| two_panels(data, number, &title, &shear_rate(data), rows)),
        title,
        caption: caption.into(),
    }
}

fn shear_rate(data: &RunData) -> Upper {
    Upper {
        label: "Shear rate (N/s)",
        value: |finger, row| finger.shear_rate[row],
        threshold: data.facts.slip_threshold,
        threshold_name: "slip threshold",
    }
}

/// What stands above the torque.
struct Upper {
    label: &'static str,
    value: fn(&FingerColumns, usize) -> f64,
    threshold: f64,
    threshold_name: &'static str,
}

/// A quantity of each finger above the torque, over a span of rows.
fn two_panels(
    data: &RunData,
    number: u32,
    title: &str,
    upper: &Upper,
    rows: Range<usize>,
) -> Option<String> {
    let time = range(data.time.get(rows.clone())?.iter().copied())?;
    let series = |value: &dyn Fn(usize) -> f64, pen| {
        let points: Vec<_> = rows
            .clone()
            .map(|row| (data.time[row], value(row)))
            .collect();
        line(thin(&points, BUCKETS), pen)
    };
    let fingers: Vec<Plot> = (data.fingers.iter().enumerate())
        .map(|(f, finger)| {
            // Later fingers thinner, so that equal lines do not hide each other.
            let pen = Pen::solid(finger_colour(f), LINE + 0.8 - 1.2 * f.min(1) as f64);
            series(&|row| (upper.value)(finger, row), pen)
        })
        .collect();
    let torque = series(&|row| 1e3 * data.torque[row], Pen::solid(CAP, LINE));
    // The same axes in every figure of a quantity, so that strokes compare at a glance.
    let largest = range((data.fingers.iter()).flat_map(|finger| {
        let moving = data.strokes.iter().flat_map(|stroke| stroke.moving.clone());
        moving.map(|row| (upper.value)(finger, row))
    }));
    let largest = largest.map_or(0.0, |(_, largest)| largest);
    let torques = range(data.torque.iter().map(|torque| 1e3 * torque))?;
    let top = 1.25 * largest.max(upper.threshold).max(1e-3);
    let threshold = ReferenceLine::horizontal(upper.threshold)
        .with_color("#555555")
        .with_stroke_width(THRESHOLD);
    let upper_panel = with_strokes(
        panel(time, (0.0, top), "", upper.label),
        data,
        time,
        Some(top),
    )
    .with_y_axis_min(0.0)
    .with_y_axis_max(top)
    .with_reference_line(threshold);
    let (low, high) = (torques.0.min(0.0), 1.08 * torques.1.max(1.0));
    let lower_panel = with_strokes(
        panel(time, (low, high), "Time (s)", "Torque (mN·m)"),
        data,
        time,
        None,
    )
    .with_y_axis_min(low)
    .with_y_axis_max(high);
    let panels = Panels::new(2, 1)
        .with_plots(vec![fingers, vec![torque]])
        .with_layouts(vec![upper_panel, lower_panel])
        .with_shared_x_all()
        .with_spacing(0.0)
        .with_padding(6.0);
    Some(frame(number, title, &legend(data, upper), panels, 380.0))
}

fn legend(data: &RunData, upper: &Upper) -> Vec<(&'static str, Pen)> {
    const NAMES: [&str; 5] = ["finger 0", "finger 1", "finger 2", "finger 3", "finger 4"];
    let fingers = NAMES.iter().enumerate().take(data.fingers.len());
    let mut legend: Vec<_> = fingers
        .map(|(f, name)| (*name, Pen::solid(finger_colour(f), LINE)))
        .collect();
    legend.push(("torque", Pen::solid(CAP, LINE)));
    legend.push((upper.threshold_name, Pen::dashed("#555555", THRESHOLD)));
    legend.push(("MOVE of stroke n", Pen::solid(SHADE, 14.0)));
    legend
}

/// Shades the MOVE phases within a span of time, and numbers the strokes at height `top`.
fn with_strokes(layout: Layout, data: &RunData, time: (f64, f64), top: Option<f64>) -> Layout {
    let mut layout = layout
        .with_x_axis_min(time.0)
        .with_x_axis_max(time.1)
        .with_force_margins(MARGINS.0, MARGINS.1);
    for stroke in data.strokes.iter().filter(|s| !s.moving.is_empty()) {
        let start = data.time[stroke.moving.start].max(time.0);
        let end = data.time[stroke.moving.end - 1].min(time.1);
        if start >= end {
            continue;
        }
        let shade = ShadedRegion::vertical(start, end);
        layout = layout.with_shaded_region(shade.with_color(SHADE).with_opacity(0.55));
        if let Some(top) = top {
            let text = stroke.index.to_string();
            let middle = 0.5 * (start + end);
            layout = layout
                .with_annotation(TextAnnotation::new(text, middle, 0.88 * top).with_font_size(15));
        }
    }
    layout
}
