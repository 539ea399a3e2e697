//! Report of the carry task: path of the object compared with its goal, and grasp forces.

use super::task_report::TaskReport;
use crate::figures::Figure;
use crate::figures::drawing::canvas::{CAP, Pen, finger_colour, finger_legend, line, panel, range};
use crate::figures::drawing::sheet::column;
use crate::measures::claim::{Claim, part};
use crate::measures::paths::MM;
use crate::measures::series::{finite, maximum};
use crate::measures::strokes::StrokeMeasures;
use crate::run::data::RunData;
use feeler_record::{CarryGoal, FindingName, ObjectPose, Recording, TaskOutcome};
use glam::{DQuat, DVec3};

/// Maximum final distance of the object from its goal (m).
const PLACE: f64 = 2e-3;
/// Maximum rotation of the object about the vertical, and maximum tilt (deg).
const TURN: f64 = 3.0;
/// Maximum distance of the object's highest position below the highest position of the path (m).
const DROP: f64 = 5e-3;

fn position(pose: &ObjectPose) -> DVec3 {
    pose.position.into()
}

/// Estimated displacement of the object along x, y and z.
const MOVED: [FindingName; 3] = [
    FindingName::MovedX,
    FindingName::MovedY,
    FindingName::MovedZ,
];

/// Rotation between two poses: angle about W's z axis, and tilt of the upright axis (rad).
fn turned(from: &ObjectPose, to: &ObjectPose) -> (f64, f64) {
    let rotation = |pose: &ObjectPose| {
        let q = &pose.orientation;
        DQuat::from_xyzw(q.x, q.y, q.z, q.w)
    };
    let turn = rotation(to) * rotation(from).inverse();
    let side = turn * DVec3::X;
    let upright = turn * DVec3::Z;
    (side.y.atan2(side.x), upright.angle_between(DVec3::Z))
}

/// Tilt of an object's upright axis between two poses (rad).
pub(crate) fn tip(from: &ObjectPose, to: &ObjectPose) -> f64 {
    turned(from, to).1
}

/// Report of the carry task.
pub struct CarryReport;

impl TaskReport for CarryReport {
    fn claims(&self, recording: &Recording, data: &RunData, _: &[StrokeMeasures]) -> Vec<Claim> {
        claims(recording, data)
    }

    fn figures(&self, recording: &Recording, data: &RunData) -> Vec<Figure> {
        vec![way(recording), grip(data)]
    }
}

/// Claims about the task.
fn claims(recording: &Recording, data: &RunData) -> Vec<Claim> {
    let goal: Option<CarryGoal> = recording.facts.carry;
    let ends = recording.object.first().zip(recording.object.last());
    let end_error = ends.zip(goal.as_ref()).map(|((first, last), goal)| {
        let way = position(last) - position(first);
        MM * (way - DVec3::from_array(goal.end)).truncate().length()
    });
    let turn = ends.map(|(first, last)| turned(first, last).0.to_degrees());
    let tip = ends.and_then(|(first, _)| {
        maximum((recording.object.iter()).map(|pose| turned(first, pose).1.to_degrees()))
    });
    let rise = ends.and_then(|(first, _)| {
        maximum((recording.object.iter()).map(|pose| position(pose).z - position(first).z))
    });
    let below = rise
        .zip(goal.as_ref())
        .map(|(rise, goal)| MM * (goal.highest - rise));
    let carried = (recording.findings.last())
        .map(|f| f64::from(u8::from(f.outcome == Some(TaskOutcome::Carried))));
    let pressing = maximum(
        data.fingers
            .iter()
            .flat_map(|finger| finger.grasp_force.iter().copied()),
    );
    let crush_force = goal.as_ref().map_or(0.0, |goal| goal.crush_force);
    vec![
        Claim::new(
            "carried",
            "The object is carried to the end of the path.",
            vec![
                part("carried").equals(carried, 1.0),
                part("distance from the end of the path")
                    .in_unit("mm")
                    .at_most(end_error, MM * PLACE),
                part("rotation about the vertical")
                    .in_unit("°")
                    .within(turn, TURN),
            ],
        ),
        Claim::new(
            "not-dropped",
            "The object does not tip, and it is lifted to the height of the path.",
            vec![
                part("tilt").in_unit("°").at_most(tip, TURN),
                part("highest position below the path's")
                    .in_unit("mm")
                    .at_most(below, MM * DROP),
            ],
        ),
        Claim::new(
            "not-crushed",
            "No finger exceeds the crush force.",
            vec![
                part("largest grasp force of a finger")
                    .in_unit("N")
                    .at_most(
                        // Without a goal there is no limit to compare with.
                        pressing.filter(|_| goal.is_some()),
                        crush_force,
                    ),
            ],
        ),
    ]
}

/// Estimate of the hand over time.
fn found(recording: &Recording, name: &FindingName) -> Vec<(f64, f64)> {
    let found = recording
        .findings
        .iter()
        .filter_map(|found| Some((found.stamp, MM * finite(found.value(name)?)?)));
    found.collect()
}

fn way(recording: &Recording) -> Figure {
    let title = "Displacement of the object";
    let names = match recording.object.is_empty() {
        false => ["x, true", "y, true", "z, true"],
        true => ["x, estimated", "y, estimated", "z, estimated"],
    };
    let start = recording.object.first().map_or(DVec3::ZERO, position);
    let (mut plots, mut legend, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for (axis, name) in names.into_iter().enumerate() {
        let truth = recording.object.iter();
        let truth: Vec<_> = truth
            .map(|pose| (pose.stamp, MM * (position(pose) - start)[axis]))
            .collect();
        let felt = found(recording, &MOVED[axis]);
        all.extend(truth.iter().chain(&felt).copied());
        let pen = Pen::solid(finger_colour(axis), 1.6);
        if recording.object.is_empty() {
            plots.push(line(felt, pen));
        } else {
            plots.push(line(truth, pen));
            plots.push(line(felt, Pen::dashed(CAP, 1.0)));
        }
        legend.push((name, pen));
    }
    let mut caption =
        "Displacement since the grasp. The estimate is computed from the fingertips that stick to the object".to_string();
    if !recording.object.is_empty() {
        legend.push(("estimated", Pen::dashed(CAP, 1.0)));
        caption += "; the true displacement is ground truth that the hand does not know";
    }
    caption += ".";
    let ranges = range(all.iter().map(|p| p.0)).zip(range(all.iter().map(|p| p.1)));
    let drawing = ranges.map(|(time, way)| {
        let layout = panel(time, way, "Time (s)", "Displacement (mm)");
        column((1, title), &legend, vec![(plots, layout)], 320.0)
    });
    Figure::drawn(1, title, caption, drawing)
}

fn grip(data: &RunData) -> Figure {
    let title = "Grasp force of each finger";
    let (mut plots, mut most) = (Vec::new(), 0.0_f64);
    let legend = finger_legend(data.fingers.len(), 1.6);
    for (columns, (_, pen)) in data.fingers.iter().zip(&legend) {
        let force = columns.grasp_force.iter().copied();
        most = most.max(maximum(force.clone()).unwrap_or(0.0));
        plots.push(line(data.time.iter().copied().zip(force), *pen));
    }
    let drawing = range(data.time.iter().copied()).map(|time| {
        let layout = panel(time, (0.0, most), "Time (s)", "Grasp force (N)");
        column((2, title), &legend, vec![(plots, layout)], 300.0)
    });
    let caption = "Sum of the compressions of a finger's elements. It increases with the pull of the object and with every slip.";
    Figure::drawn(2, title, caption, drawing)
}
