//! What the hand felt of a cap, over time, against the rig's instruments.

use super::super::cap::{CapMeasures, Felt};
use super::super::run_data::RunData;
use super::Figure;
use super::canvas::{CAP, Pen, SHADE, finger_colour, frame, line, panel, range, thin};
use feeler_record::{FindingName, Recording};
use kuva::render::annotations::{ReferenceLine, ShadedRegion};
use kuva::render::figure::Figure as Panels;
use kuva::render::layout::Layout;

/// Pairs of points that a series is thinned to.
const BUCKETS: usize = 480;
/// Left and right of both panels, so that their times stand one above the other.
const MARGINS: (f64, f64) = (64.0, 20.0);
/// All of a recording.
const ALWAYS: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Draws what there is to draw of a cap: torque and turn over the run.
pub fn figures(recording: &Recording, data: &RunData, cap: &CapMeasures) -> Vec<Figure> {
    let title = "Torque and turn, felt and measured";
    let caption = "The torque that the hand feels is the sum of shear forces times their distance from the axis; nothing is felt \
        between strokes. The turn that it feels is the way of sticking elements over the radius. The torque sensor and the cap's true angle are not \
        the hand's to know. Dashed is what friction allows with the whole grip.";
    vec![Figure {
        number: 1,
        title: title.into(),
        caption: caption.into(),
        svg: torque_and_turn(recording, data, cap, title),
    }]
}

fn torque_and_turn(
    recording: &Recording,
    data: &RunData,
    cap: &CapMeasures,
    title: &str,
) -> Option<String> {
    let (felt, sense) = (Felt::new(recording), data.facts.cap?.sense);
    let time = range(data.time.iter().copied())?;
    let measured = |values: &[f64], factor: f64| -> Vec<_> {
        let points = data.time.iter().zip(values);
        points.map(|(&t, value)| (t, factor * value)).collect()
    };
    let own = |name: &FindingName, factor: f64| -> Vec<_> {
        let points = felt.series(name, ALWAYS).into_iter();
        points.map(|(t, value)| (t, factor * value)).collect()
    };
    let (truth, hand) = (Pen::solid(CAP, 2.4), Pen::solid(finger_colour(1), 1.4));
    let torques = [
        measured(&data.torque, 1e3 * sense),
        own(&FindingName::Torque, 1e3),
    ];
    let turns = [
        measured(&data.cap_angle, sense * 1f64.to_degrees()),
        own(&FindingName::Turned, 1f64.to_degrees()),
    ];
    let limit = 1e3 * cap.friction_limit;
    let panel_of = |points: &[Vec<(f64, f64)>; 2], least: f64, x: &str, y: &str| {
        let (low, high) = range(points.iter().flatten().map(|p| p.1)).unwrap_or((0.0, 1.0));
        let (low, high) = (low.min(0.0), 1.08 * high.max(least).max(1.0));
        let layout = panel(time, (low, high), x, y).with_y_axis_min(low);
        with_strokes(layout.with_y_axis_max(high), data, time)
    };
    let dashed = ReferenceLine::horizontal(limit)
        .with_color("#555555")
        .with_stroke_width(1.4);
    let upper = panel_of(&torques, limit, "", "Torque (mN·m)").with_reference_line(dashed);
    let lower = panel_of(&turns, 0.0, "Time (s)", "Turn (°)");
    // Nothing is felt of the torque between strokes; a line across would seem to say otherwise.
    let strokes = data.strokes.iter().filter(|s| !s.moving.is_empty());
    let felt_torques = strokes.map(|stroke| {
        let (start, end) = (stroke.moving.start, stroke.moving.end - 1);
        let times = (data.time[start], data.time[end]);
        let points = felt.series(&FindingName::Torque, times).into_iter();
        line(points.map(|(t, torque)| (t, 1e3 * torque)), hand)
    });
    let mut upper_lines = vec![line(thin(&torques[0], BUCKETS), truth)];
    upper_lines.extend(felt_torques);
    let lower_lines = vec![
        line(thin(&turns[0], BUCKETS), truth),
        line(thin(&turns[1], BUCKETS), hand),
    ];
    let panels = Panels::new(2, 1)
        .with_plots(vec![upper_lines, lower_lines])
        .with_layouts(vec![upper, lower])
        .with_shared_x_all()
        .with_spacing(0.0)
        .with_padding(6.0);
    let legend = [
        ("torque sensor, true angle", truth),
        ("felt", hand),
        ("limit of friction", Pen::dashed("#555555", 1.4)),
        ("MOVE", Pen::solid(SHADE, 14.0)),
    ];
    Some(frame(1, title, &legend, panels, 380.0))
}

/// Shades the MOVE phases.
fn with_strokes(layout: Layout, data: &RunData, time: (f64, f64)) -> Layout {
    let mut layout = layout
        .with_x_axis_min(time.0)
        .with_x_axis_max(time.1)
        .with_force_margins(MARGINS.0, MARGINS.1);
    for stroke in data.strokes.iter().filter(|s| !s.moving.is_empty()) {
        let (start, end) = (stroke.moving.start, stroke.moving.end - 1);
        let shade = ShadedRegion::vertical(data.time[start], data.time[end]);
        layout = layout.with_shaded_region(shade.with_color(SHADE).with_opacity(0.55));
    }
    layout
}
