//! Report of the grip task: grip force, load, friction estimate, and success of the hold.

use super::task_report::TaskReport;
use crate::figures::Figure;
use crate::figures::drawing::canvas::{Pen, finger_colour, line, panel, range};
use crate::figures::drawing::sheet::column;
use crate::measures::claim::{Claim, part};
use crate::measures::paths::MM;
use crate::measures::series::{finite, maximum};
use crate::measures::strokes::StrokeMeasures;
use crate::run::data::RunData;
use feeler_record::{FindingName, Recording, TaskOutcome};
use glam::DVec3;

/// Maximum displacement of the object in the grip (mm).
const SLIDE: f64 = 15.0;

/// Report of the grip task.
pub struct GripReport;

impl TaskReport for GripReport {
    fn claims(&self, recording: &Recording, _: &RunData, _: &[StrokeMeasures]) -> Vec<Claim> {
        let last = recording.findings.last();
        let put_down = last.map(|f| f64::from(u8::from(f.outcome == Some(TaskOutcome::PutDown))));
        let start = recording
            .object
            .first()
            .map(|pose| DVec3::from(pose.position));
        let moved = start.and_then(|start| {
            let positions = recording
                .object
                .iter()
                .map(|pose| DVec3::from(pose.position));
            maximum(positions.map(|position| MM * position.distance(start)))
        });
        vec![
            Claim::new(
                "put-down",
                "The object is held until it is put down.",
                vec![part("put down").equals(put_down, 1.0)],
            ),
            Claim::new(
                "not-slipped",
                "The object does not move far in the grip.",
                vec![
                    part("largest displacement relative to the gripper")
                        .in_unit("mm")
                        .at_most(moved, SLIDE),
                ],
            ),
        ]
    }

    fn figures(&self, recording: &Recording, _: &RunData) -> Vec<Figure> {
        vec![forces(recording), friction(recording)]
    }
}

/// Values of a finding over time.
fn found(recording: &Recording, name: &FindingName) -> Vec<(f64, f64)> {
    let values = recording.findings.iter();
    let values = values.filter_map(|found| Some((found.stamp, finite(found.value(name)?)?)));
    values.collect()
}

fn forces(recording: &Recording) -> Figure {
    let title = "Grip and load";
    let (grip, load) = (
        Pen::solid(finger_colour(0), 1.6),
        Pen::solid(finger_colour(1), 1.6),
    );
    let lines = [
        found(recording, &FindingName::Pressing),
        found(recording, &FindingName::Load),
    ];
    let ranges = range(lines.iter().flatten().map(|point| point.0)).zip(range(
        lines.iter().flatten().map(|point| point.1).chain([0.0]),
    ));
    let drawing = ranges.map(|(time, force)| {
        let layout = panel(time, force, "Time (s)", "Force (N)");
        let plots = lines.into_iter().zip([grip, load]);
        let plots = plots.map(|(points, pen)| line(points, pen)).collect();
        let legend = [("grip of a finger", grip), ("load of a finger", load)];
        column((1, title), &legend, vec![(plots, layout)], 320.0)
    });
    let caption =
        "The grip follows the load, which is felt as shear and torsion of the fingertips.";
    Figure::drawn(1, title, caption.to_string(), drawing)
}

fn friction(recording: &Recording) -> Figure {
    let title = "Friction estimate";
    let points = found(recording, &FindingName::Friction);
    let time = range(points.iter().map(|point| point.0));
    let most = maximum(points.iter().map(|point| point.1)).unwrap_or(1.0);
    let drawing = time.map(|time| {
        let layout = panel(time, (0.0, most), "Time (s)", "Coefficient of friction");
        let pen = Pen::solid(finger_colour(2), 1.6);
        let plots = vec![line(points, pen)];
        column(
            (2, title),
            &[("estimate", pen)],
            vec![(plots, layout)],
            260.0,
        )
    });
    let caption = "Largest ratio of shear to pressing force at the edge of the contacts, which slips before its middle.";
    Figure::drawn(2, title, caption.to_string(), drawing)
}
