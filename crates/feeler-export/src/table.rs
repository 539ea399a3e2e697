//! Exports a recording as a Parquet table with one row per control step.

use crate::columnar::{AnyCells, ParquetFile};
use crate::columns::{Columns, Described};
use crate::error::ExportError;
use crate::joint_units::joint_units;
use feeler_record::wire::{Quaternion, Vector3};
use feeler_record::{NO_ELEMENT, Recording, RunFacts, Step, Steps};
use serde_json::{Map, Value, json};
use std::io::Write;

/// Number of rows per row group.
const ROWS_OF_A_GROUP: usize = 8192;

/// Writes `recording` to `out` as a Parquet file with one row per control step. Each row contains the latest message of
/// every channel at that step, or null before the first message. Values are bit-identical to the recording. The column
/// `run` contains `run` in every row.
///
/// File metadata: `feeler.columns` (JSON: unit and meaning of each column), `feeler.run` (JSON: the run's constants),
/// `feeler.digest`, and `feeler.problem` (reason why the recording is incomplete; empty if it is complete).
///
/// # Errors
/// If the file cannot be written.
pub fn write<W: Write + Send>(run: &str, recording: &Recording, out: W) -> Result<(), ExportError> {
    let mut steps = Steps::new(recording);
    let mut next_group = || steps.by_ref().take(ROWS_OF_A_GROUP).collect::<Vec<_>>();
    let mut group = next_group();
    let columns = table_columns(run, recording, &group);
    let about = about(recording, &columns);
    let mut columns: Vec<_> = columns
        .into_iter()
        .map(|described| described.column)
        .collect();
    let mut file = ParquetFile::create(out, &columns, about)?;
    while !group.is_empty() {
        file.write(&columns)?;
        group = next_group();
        let next = table_columns(run, recording, &group);
        columns = next.into_iter().map(|described| described.column).collect();
    }
    Ok(file.close()?)
}

/// Key-value metadata of the file.
fn about(recording: &Recording, columns: &[Described]) -> Vec<(String, String)> {
    let columns: Map<_, _> = columns.iter().map(Described::description).collect();
    let facts: &RunFacts = &recording.facts;
    let run = json!({
        "experiment": facts.experiment,
        "task": facts.task,
        "seed": facts.seed,
        "version": facts.version,
        "sensing": facts.sensing,
        "law": facts.law,
        "control_period_s": facts.control_period,
        "state": recording.end.state,
        "reason": recording.end.reason,
    });
    let problem = recording.problem.clone().unwrap_or_default();
    let texts = [
        ("feeler.columns", Value::Object(columns).to_string()),
        ("feeler.run", run.to_string()),
        ("feeler.digest", recording.digest.to_string()),
        ("feeler.problem", problem),
    ];
    texts.map(|(key, text)| (key.to_string(), text)).into()
}

/// Columns for these steps. All row groups have the same columns.
fn table_columns(run: &str, recording: &Recording, steps: &[Step<'_>]) -> Vec<Described> {
    let mut columns = Columns::of(steps);
    let runs = steps.iter().map(|_| run);
    columns.add("run", "", "name of the run", AnyCells::texts(runs));
    columns.number("timestamp", "s", "time of the control step", |s| {
        Some(s.task.stamp)
    });
    let phases = AnyCells::texts(steps.iter().map(|s| s.task.phase));
    columns.add("phase", "", "phase that the command belongs to", phases);
    columns.whole("stroke", "from 1; 0 before the first", |s| {
        Some(s.task.stroke.into())
    });
    for finger in 0..recording.fingers.len() {
        columns.prefix = format!("finger_{finger}_");
        let model = recording.facts.hand.get(finger..=finger);
        let units = joint_units(model.unwrap_or_default());
        motion_columns(&mut columns, finger, units);
        touch_columns(&mut columns, finger);
        if !recording.true_slip.is_empty() {
            let slid = "longest distance that the anchor of a feeler slid since the previous step (ground truth)";
            columns.number("true_slip", "m", slid, move |s| {
                s.true_slip?.distance.get(finger).copied()
            });
        }
    }
    columns.prefix = String::new();
    instrument_columns(&mut columns, recording);
    columns.made
}

/// Measured and commanded motion of a finger.
fn motion_columns(
    columns: &mut Columns<'_, '_>,
    finger: usize,
    [position, velocity]: [&'static str; 2],
) {
    columns.list(
        "joint_position",
        position,
        "encoders, from the base to the fingertip",
        move |s| Some(s.finger(finger)?.joints?.position),
    );
    columns.list(
        "joint_velocity",
        velocity,
        "encoders, from the base to the fingertip",
        move |s| Some(s.finger(finger)?.joints?.velocity),
    );
    columns.list(
        "command_joint_velocity",
        velocity,
        "as sent to the drives",
        move |s| Some(s.finger(finger)?.command?.joint_velocity),
    );
    let asked = "world frame; as requested, before limiting";
    columns.list("command_fingertip_velocity", "m/s", asked, move |s| {
        Some(xyz(s.finger(finger)?.command?.fingertip_velocity))
    });
    columns.flag(
        "command_limited",
        "a limit changed the requested velocity",
        move |s| Some(s.finger(finger)?.command?.limited),
    );
    columns.list(
        "fingertip_position",
        "m",
        "centre of the dome in the world frame",
        move |s| Some(xyz(s.finger(finger)?.fingertip?.position)),
    );
    let turned = "quaternion x, y, z, w: from the fingertip frame to the world frame";
    columns.list("fingertip_orientation", "", turned, move |s| {
        Some(xyzw(s.finger(finger)?.fingertip?.orientation))
    });
}

/// Tactile measurements of a finger.
fn touch_columns(columns: &mut Columns<'_, '_>, finger: usize) {
    columns.number(
        "sensed_at",
        "s",
        "time of the image from which forces and flags were computed",
        move |s| Some(s.finger(finger)?.tactile?.stamp),
    );
    let tangential = "tangential force on each element by the object, in the element's frame";
    let compression = "compression of each element, positive when pressed";
    let mut force = |name, meaning, component: fn(&Vector3) -> f64| {
        columns.list(name, "N", meaning, move |s| {
            Some(s.finger(finger)?.tactile?.forces.iter().map(component))
        });
    };
    force("force_x", tangential, |force| force.x);
    force("force_y", tangential, |force| force.y);
    force("force_z", compression, |force| force.z);
    columns.list(
        "shear_rate",
        "N/s",
        "|d(F_x, F_y)/dt| of each element",
        move |s| Some(s.finger(finger)?.flags?.shear_rate.iter().copied()),
    );
    columns.flag(
        "touch",
        "an element is pressed harder than F1, or slip",
        move |s| Some(s.finger(finger)?.flags?.touch),
    );
    columns.flag("slip", "an element's shear rate exceeds dr", move |s| {
        Some(s.finger(finger)?.flags?.slip)
    });
    columns.flag("over", "an element is pressed harder than F2", move |s| {
        Some(s.finger(finger)?.flags?.over)
    });
    columns.number(
        "grasp_force",
        "N",
        "sum of the positive compressions",
        move |s| Some(s.finger(finger)?.flags?.grasp_force),
    );
    let largest =
        "touching element with the largest compression, from 0; null if no element touches";
    columns.whole("largest_element", largest, move |s| {
        let element = s.finger(finger)?.flags?.largest_element;
        (element != NO_ELEMENT).then_some(element.into())
    });
}

/// Measurements of the rig's instruments and ground truth of the simulator (`true_`), where recorded.
fn instrument_columns(columns: &mut Columns<'_, '_>, recording: &Recording) {
    if !recording.torque_sensor.is_empty() {
        let torque = "measured torque on the bottle by the cap; positive when the cap is turned in the closing direction";
        columns.number("torque", "N m", torque, |s| Some(s.torque?.torque));
    }
    if !recording.cap.is_empty() {
        let turned = "rotation of the cap since the start, positive = closing";
        columns.number("true_cap_angle", "rad", turned, |s| Some(s.cap?.angle));
        columns.list("true_cap_centre", "m", "world frame", |s| {
            Some(xyz(s.cap?.centre))
        });
        let resists = "torque between cap and bottle, positive when it resists closing";
        columns.number("true_resisting_torque", "N m", resists, |s| {
            Some(s.cap?.resisting_torque)
        });
    }
    if !recording.object.is_empty() {
        columns.list("true_object_position", "m", "world frame", |s| {
            Some(xyz(s.object?.position))
        });
        let turned = "quaternion x, y, z, w: from the object's frame to the world frame";
        columns.list("true_object_orientation", "", turned, |s| {
            Some(xyzw(s.object?.orientation))
        });
    }
}

fn xyz(vector: Vector3) -> [f64; 3] {
    [vector.x, vector.y, vector.z]
}

fn xyzw(quaternion: Quaternion) -> [f64; 4] {
    [quaternion.x, quaternion.y, quaternion.z, quaternion.w]
}
