//! Figure of a cap closed or opened by touch: the hand's estimates over time, with the instruments' values.

use super::Figure;
use crate::figures::drawing::canvas::{
    BUCKETS, CAP, Pen, REFERENCE, SHADE, exact_panel, finger_colour, line, range, thin, with_moves,
};
use crate::figures::drawing::sheet::{Drawing, column};
use crate::measures::cap::{CapEstimates, CapMeasures};
use crate::run::data::RunData;
use feeler_record::{FindingName, Recording};
use kuva::render::annotations::ReferenceLine;

/// Time span that contains a whole recording (s).
const ALWAYS: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Figure of torque and rotation over the run.
pub fn figures(recording: &Recording, data: &RunData, cap: &CapMeasures) -> Vec<Figure> {
    let (title, caption) =
        match cap.sense.is_some() && (data.torque.is_some() || data.cap.is_some()) {
            true => (
                "Torque and rotation, estimated and measured",
                [FELT, JUDGES].concat(),
            ),
            false => ("Estimated torque and rotation", FELT.to_string()),
        };
    let limit = if cap.friction_limit.is_some() {
        LIMIT
    } else {
        ""
    };
    let drawing = torque_and_turn(recording, data, cap, title);
    vec![Figure::drawn(1, title, caption + limit, drawing)]
}

const FELT: &str = "The estimated torque is the sum of shear forces times their distance from the axis; there is no estimate \
    between strokes. The estimated rotation is the displacement of sticking elements divided by the radius.";
const JUDGES: &str = " The hand uses neither the torque sensor nor the cap's true angle.";
const LIMIT: &str = " The dashed line is the torque limit of friction at full grasp force.";

/// Pen of measured or true values.
const TRUTH: Pen = Pen::solid(CAP, 2.4);
/// Pen of the friction limit.
const LIMIT_PEN: Pen = Pen::dashed(REFERENCE, 1.4);

/// Points (time in s, value).
type Points = Vec<(f64, f64)>;

fn torque_and_turn(
    recording: &Recording,
    data: &RunData,
    cap: &CapMeasures,
    title: &str,
) -> Option<Drawing> {
    let felt = CapEstimates::new(recording);
    let time = range(data.time.iter().copied())?;
    let measured = |values: Option<&Vec<f64>>, factor: f64| -> Points {
        let known = values.zip(cap.sense).into_iter();
        let points = known.flat_map(|(values, sense)| {
            let points = data.time.iter().zip(values);
            points.map(move |(&t, value)| (t, factor * (sense * value)))
        });
        points.filter(|point| point.1.is_finite()).collect()
    };
    let own = |name: &FindingName, factor: f64| -> Points {
        let points = felt.series(name, ALWAYS).into_iter();
        points.map(|(t, value)| (t, factor * value)).collect()
    };
    let hand = Pen::solid(finger_colour(1), 1.4);
    let torques = [
        measured(data.torque.as_ref(), 1e3),
        own(&FindingName::Torque, 1e3),
    ];
    let turns = [
        measured(data.cap.as_ref().map(|cap| &cap.angle), 1f64.to_degrees()),
        own(&FindingName::Turned, 1f64.to_degrees()),
    ];
    let limit = cap.friction_limit.map(|limit| 1e3 * limit);
    let strokes = data.strokes.iter().filter(|s| !s.moving.is_empty());
    let moves = strokes.map(|stroke| {
        let (start, end) = (stroke.moving.start, stroke.moving.end - 1);
        (data.time[start], data.time[end])
    });
    let moves: Vec<_> = moves.collect();
    let panel_of = |points: &[Points; 2], least: f64, x: &str, y: &str| {
        let (low, high) = range(points.iter().flatten().map(|p| p.1))?;
        let (low, high) = (low.min(0.0), 1.08 * high.max(least).max(1.0));
        let layout = exact_panel(time, (low, high), x, y);
        Some(with_moves(layout, moves.clone()))
    };
    let upper = panel_of(&torques, limit.unwrap_or(0.0), "", "Torque (mN·m)")?;
    let upper = limit.into_iter().fold(upper, |layout, limit| {
        let line = ReferenceLine::horizontal(limit).with_color(LIMIT_PEN.colour);
        layout.with_reference_line(line.with_stroke_width(LIMIT_PEN.width))
    });
    let lower = panel_of(&turns, 0.0, "Time (s)", "Rotation (°)")?;
    // There is no torque estimate between strokes, so each stroke is a separate line.
    let felt_torques = moves.iter().map(|&times| {
        let points = felt.series(&FindingName::Torque, times).into_iter();
        line(points.map(|(t, torque)| (t, 1e3 * torque)), hand)
    });
    let of_instruments = |points: &Points| {
        let points = (!points.is_empty()).then(|| thin(points, BUCKETS));
        points.map(|points| line(points, TRUTH))
    };
    let mut upper_lines: Vec<_> = of_instruments(&torques[0]).into_iter().collect();
    upper_lines.extend(felt_torques);
    let mut lower_lines: Vec<_> = of_instruments(&turns[0]).into_iter().collect();
    lower_lines.push(line(thin(&turns[1], BUCKETS), hand));
    let truth = match [&torques, &turns].map(|lines| !lines[0].is_empty()) {
        [true, true] => Some("torque sensor, true angle"),
        [true, false] => Some("torque sensor"),
        [false, true] => Some("true angle"),
        [false, false] => None,
    };
    let mut legend: Vec<_> = truth.into_iter().map(|name| (name, TRUTH)).collect();
    legend.push(("estimated", hand));
    legend.extend(limit.map(|_| ("friction limit", LIMIT_PEN)));
    legend.push(("MOVE", Pen::solid(SHADE, 14.0)));
    let panels = vec![(upper_lines, upper), (lower_lines, lower)];
    Some(column((1, title), &legend, panels, 380.0))
}
