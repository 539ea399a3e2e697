//! The carry task: where the object went, against where it should go, and how hard it was gripped.

use super::{TaskReport, findings};
use crate::claim::{Claim, ClaimPart, Relation};
use crate::figures::Figure;
use crate::figures::canvas::{CAP, Pen, finger_colour, line, panel, range};
use crate::figures::drawing::column;
use crate::run_data::RunData;
use crate::series::{finite, maximum};
use crate::strokes::StrokeMeasures;
use crate::summary::Summary;
use feeler_record::{CarryGoal, FindingName, ObjectPose, Recording, TaskOutcome};
use glam::{DQuat, DVec3};
use maud::Markup;

/// How far the object may end from its goal, m.
const PLACE: f64 = 2e-3;
/// How far it may have turned, and how far it may tip, deg.
const TURN: f64 = 3.0;
/// How much lower than the path's highest place it may stay, m.
const DROP: f64 = 5e-3;
/// Metres to millimetres.
const MM: f64 = 1e3;

fn position(pose: &ObjectPose) -> DVec3 {
    pose.position.into()
}

/// Way of the object along x, y and z.
const MOVED: [FindingName; 3] = [
    FindingName::MovedX,
    FindingName::MovedY,
    FindingName::MovedZ,
];

/// How a pose is turned from another: about W's z, and by how much its upright axis tips, rad.
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

/// By how much the upright axis of an object tips from one pose to another, rad.
pub(crate) fn tip(from: &ObjectPose, to: &ObjectPose) -> f64 {
    turned(from, to).1
}

/// The report of this task.
pub struct CarryReport;

impl TaskReport for CarryReport {
    fn whose(&self) -> &'static str {
        "of this task"
    }

    fn claims(&self, recording: &Recording, data: &RunData, _: &[StrokeMeasures]) -> Vec<Claim> {
        claims(recording, data)
    }

    fn figures(&self, recording: &Recording, data: &RunData) -> Vec<Figure> {
        figures(recording, data)
    }

    fn verdict(&self, _: &Recording, summary: &Summary) -> Markup {
        findings::verdict(summary)
    }

    fn measured(&self, _: &Recording, summary: &Summary) -> Markup {
        findings::table(summary)
    }
}

/// What the task is held to.
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
            "The object is carried to the path's end.",
            vec![
                ClaimPart::new("carried", carried, Relation::Equals, 1.0),
                ClaimPart::new(
                    "distance from the path's end",
                    end_error,
                    Relation::AtMost,
                    MM * PLACE,
                )
                .in_unit("mm"),
                ClaimPart::new("turned about the upright", turn, Relation::Within, TURN)
                    .in_unit("°"),
            ],
        ),
        Claim::new(
            "not-dropped",
            "It neither tips nor stays behind.",
            vec![
                ClaimPart::new("tipped", tip, Relation::AtMost, TURN).in_unit("°"),
                ClaimPart::new(
                    "highest place below the path's",
                    below,
                    Relation::AtMost,
                    MM * DROP,
                )
                .in_unit("mm"),
            ],
        ),
        Claim::new(
            "not-crushed",
            "No finger presses harder than it may.",
            vec![
                ClaimPart::new(
                    "largest grasp force of a finger",
                    // Without a goal there is nothing that it is held to.
                    pressing.filter(|_| goal.is_some()),
                    Relation::AtMost,
                    crush_force,
                )
                .in_unit("N"),
            ],
        ),
    ]
}

/// Where the object went, and how hard it was gripped.
fn figures(recording: &Recording, data: &RunData) -> Vec<Figure> {
    vec![way(recording), grip(data)]
}

/// What the hand found, as a series over time.
fn found(recording: &Recording, name: &FindingName) -> Vec<(f64, f64)> {
    let found = recording
        .findings
        .iter()
        .filter_map(|found| Some((found.stamp, MM * finite(found.value(name)?)?)));
    found.collect()
}

fn way(recording: &Recording) -> Figure {
    let title = "How far the object moved";
    let names = match recording.object.is_empty() {
        false => ["x, true", "y, true", "z, true"],
        true => ["x, as felt", "y, as felt", "z, as felt"],
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
        "From where it was taken. Felt is what the tips say that stick to the object".to_string();
    if !recording.object.is_empty() {
        legend.push(("as felt", Pen::dashed(CAP, 1.0)));
        caption += "; the true way is the simulator's, and the hand does not know it";
    }
    caption += ".";
    let ranges = range(all.iter().map(|p| p.0)).zip(range(all.iter().map(|p| p.1)));
    let drawing = ranges.map(|(time, way)| {
        let layout = panel(time, way, "Time (s)", "Moved (mm)");
        column((1, title), &legend, vec![(plots, layout)], 320.0)
    });
    Figure::drawn(1, title, caption, drawing)
}

fn grip(data: &RunData) -> Figure {
    let title = "Grasp force of each finger";
    const NAMES: [&str; 5] = ["finger 0", "finger 1", "finger 2", "finger 3", "finger 4"];
    let (mut plots, mut legend, mut most) = (Vec::new(), Vec::new(), 0.0_f64);
    for (finger, columns) in data.fingers.iter().enumerate().take(NAMES.len()) {
        let pen = Pen::solid(finger_colour(finger), 1.6);
        let force = columns.grasp_force.iter().copied();
        most = most.max(maximum(force.clone()).unwrap_or(0.0));
        plots.push(line(data.time.iter().copied().zip(force), pen));
        legend.push((NAMES[finger], pen));
    }
    let drawing = range(data.time.iter().copied()).map(|time| {
        let layout = panel(time, (0.0, most), "Time (s)", "Grasp force (N)");
        column((2, title), &legend, vec![(plots, layout)], 300.0)
    });
    let caption = "The sum of the compressions of a finger's elements. It grows with what the object pulls, and with every slip.";
    Figure::drawn(2, title, caption, drawing)
}
