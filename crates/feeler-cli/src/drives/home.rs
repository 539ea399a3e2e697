//! The `feeler drives home` subcommand.

use super::HomeArguments;
use super::output::NewExperiment;
use crate::{CommandError, Outcome};
use feeler::hand::FingerGeometry;
use feeler_drives::setup::{check_model, named_joints, read_counts};
use feeler_lab::experiment::fingers_at_home;
use feeler_rig::{ServoRig, display_unit};
use std::collections::BTreeMap;
use std::io::Write;

pub fn home(arguments: &HomeArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let rig = arguments.rig.load()?;
    let angles = posture(&rig, &arguments.at)?;
    let file = NewExperiment::create(&arguments.output, &arguments.rig, &arguments.overwrite)?;
    if arguments.rig.dry_run {
        for ((joint, drive), angle) in named_joints(&rig.config).zip(&angles) {
            let (unit, size) = display_unit(drive);
            writeln!(
                out,
                "would read the position of {joint} as {:.3} {unit}; writes nothing to it",
                angle / size
            )?;
        }
        return Ok(Outcome::Done);
    }
    let mut bus = rig.open()?;
    let mut settings = Vec::new();
    // The first joint of a servo precedes the joints that share it.
    let mut positions = BTreeMap::new();
    for ((joint, drive), &angle) in named_joints(&rig.config).zip(&angles) {
        let (model, counts) = match positions.get(&joint.id) {
            Some(&read) => read,
            None => {
                let model = check_model(&mut bus, joint, drive)?;
                let read = (model, read_counts(&mut bus, joint)?);
                positions.insert(joint.id, read);
                read
            }
        };
        let offset = angle - drive.turn(model.to_angle(counts as f64));
        let key = format!(
            "drives.finger.{}.joint.{}.homing_offset",
            joint.finger, joint.joint
        );
        let (unit, size) = display_unit(drive);
        writeln!(
            out,
            "{joint}: {counts} counts are {:.3} {unit}: homing_offset = {offset:.6}",
            angle / size
        )?;
        settings.push(format!("{key}={offset}"));
    }
    match file {
        Some(file) => file.write(&rig, &settings, out)?,
        None => writeln!(
            out,
            "copy these into [drives], or write them with --output FILE"
        )?,
    }
    Ok(Outcome::Done)
}

/// Returns the hand's present joint positions (rad or m): `said` (deg or mm), or those of the task's home posture if
/// empty.
fn posture(rig: &ServoRig, said: &[f64]) -> Result<Vec<f64>, CommandError> {
    let joints = rig.fingers.iter().map(FingerGeometry::joint_count);
    let usual = joints.clone().all(|joints| joints == 3);
    let joints: usize = joints.sum();
    if said.is_empty() {
        let (_, home) = fingers_at_home(&rig.experiment.config)?;
        return Ok(home
            .iter()
            .flat_map(|angles| angles.as_slice())
            .copied()
            .collect());
    }
    if said.len() != joints || !said.iter().all(|angle| angle.abs() <= 360.0) {
        let each = if usual {
            "three per finger"
        } else {
            "one per joint"
        };
        return Err(format!(
            "--at: expected {joints} positions from -360 to 360 deg (mm of prismatic joints), {each}, separated by commas"
        )
        .into());
    }
    let sizes = rig.config.joints().map(|drive| display_unit(drive).1);
    Ok(said.iter().zip(sizes).map(|(at, size)| at * size).collect())
}
