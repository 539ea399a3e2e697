//! The `feeler drives jog` subcommand.

use super::{JogArguments, JointArguments};
use crate::{CommandError, Outcome};
use feeler::hand::{Hand, HandState};
use feeler::pace::{FixedRate, Schedule};
use feeler_console::watch_for_interrupt;
use feeler_drives::config::JointDriveConfig;
use feeler_drives::hand::DriveHand;
use feeler_drives::setup::{joints_of_servo, named_joints, servo_range};
use feeler_drives::{DriveError, JointName, RigClock};
use feeler_rig::{ServoRig, all_changes, display_unit, print_changes};
use std::io::Write;
use std::sync::atomic::Ordering;

/// Maximum angle of a jog (deg, or mm of a prismatic joint).
pub(super) const MOST: f64 = 10.0;
/// Time (s) that a joint may take in addition to the time computed from its speed.
pub(super) const GRACE: f64 = 1.0;

pub fn jog(arguments: &JogArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let rig = arguments.rig.load()?;
    let (joint, drive) = joint_drive(&rig, arguments.joint.place())?;
    let (unit, size) = display_unit(drive);
    if arguments.by.is_nan() || arguments.by.abs() > MOST {
        return Err(format!(
            "--by {}: expected at most {MOST} {unit} in either direction",
            arguments.by
        )
        .into());
    }
    check_speed(arguments.speed, drive)?;
    check_others(&rig, (arguments.by, arguments.speed), (joint, drive))?;
    if arguments.rig.dry_run {
        return plan(&rig, arguments, (joint, unit), out);
    }
    turn(&rig, arguments, joint, (unit, size), out)
}

/// Checks a `speed`, in the display unit of the joint of `drive` per second.
pub(super) fn check_speed(speed: f64, drive: &JointDriveConfig) -> Result<(), CommandError> {
    let (unit, size) = display_unit(drive);
    let most = drive.jog_speed() / size;
    if !(speed > 0.0 && speed <= most) {
        return Err(format!(
            "--speed {speed}: expected a speed above 0, at most {most:.1} {unit}/s"
        )
        .into());
    }
    Ok(())
}

/// Checks the motion of the other joints that the servo of `drive` moves, if it moves `joint` by a distance at a speed, in
/// its display unit.
pub(super) fn check_others(
    rig: &ServoRig,
    (by, speed): (f64, f64),
    (joint, drive): (JointName, &JointDriveConfig),
) -> Result<(), CommandError> {
    let (_, size) = display_unit(drive);
    let others = joints_of_servo(&rig.config, joint.id).filter(|(name, _)| *name != joint);
    for (name, other) in others {
        let (unit, other_size) = display_unit(other);
        let ratio = (other.ratio_to(drive) * size / other_size).abs();
        let moves = [
            ("--by", by.abs(), MOST, unit.to_string()),
            (
                "--speed",
                speed,
                other.jog_speed() / other_size,
                format!("{unit}/s"),
            ),
        ];
        for (option, value, most, unit) in moves {
            // Rounding must not refuse joints that move alike.
            if ratio * value > most * (1.0 + 1e-9) {
                return Err(format!(
                    "{option} {value}: expected at most {most:.1} {unit} of theta{} of finger {}, which the servo moves by {:.1} {unit}",
                    name.joint + 1,
                    name.finger,
                    ratio * value
                )
                .into());
            }
        }
    }
    Ok(())
}

/// Returns the joint with these indices, and its servo.
///
/// # Errors
/// If the hand has no such joint.
pub(super) fn joint_drive(
    rig: &ServoRig,
    (finger, joint): (usize, usize),
) -> Result<(JointName, &JointDriveConfig), DriveError> {
    named_joints(&rig.config)
        .find(|(name, _)| (name.finger, name.joint) == (finger, joint))
        .ok_or_else(|| DriveError::no_joint(finger, joint, &rig.fingers))
}

/// Names the other joints that the servo of `joint` moves; empty if it moves no other.
pub(super) fn moved_with(rig: &ServoRig, joint: JointName) -> String {
    joints_of_servo(&rig.config, joint.id)
        .filter(|(name, _)| *name != joint)
        .map(|(name, _)| format!(" with theta{} of finger {}", name.joint + 1, name.finger))
        .collect()
}

/// Prints the planned writes without executing them.
fn plan(
    rig: &ServoRig,
    arguments: &JogArguments,
    (moved, unit): (JointName, &str),
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let planned = all_changes(&mut rig.open()?, &rig.config, &rig.fingers)?;
    print_changes(&planned, out)?;
    let JogArguments { by, speed, .. } = arguments;
    let JointArguments { finger, joint } = arguments.joint;
    writeln!(
        out,
        "would enable torque of all servos, turn theta{joint} of finger {finger}{} by {by} {unit} at {speed} {unit}/s, and disable torque; nothing was written",
        moved_with(rig, moved)
    )?;
    Ok(Outcome::Done)
}

/// Turns the joint, and prints its final position in `unit`, whose size is given in rad or m.
fn turn(
    rig: &ServoRig,
    arguments: &JogArguments,
    moved: JointName,
    (unit, size): (&str, f64),
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let JointName { finger, joint, .. } = moved;
    let control = &rig.experiment.config.control;
    let (period, most_age) = (control.period, control.stale_periods * control.period);
    let interrupted = watch_for_interrupt()?;
    let mut hand = DriveHand::open(&rig.config, &rig.fingers, most_age, RigClock::real())?;
    let mut state = HandState::zero(rig.fingers.len());
    hand.read(&mut state)?;
    let begin = state.joints[finger].position[joint];
    let (by, speed) = (arguments.by * size, arguments.speed * size);
    let (lower, upper) = servo_range(&rig.config, &rig.fingers, moved)?;
    let limits = lower..=upper;
    if !limits.contains(&(begin + by)) {
        let (from, to) = (begin / size, (begin + by) / size);
        let (lower, upper) = (limits.start() / size, limits.end() / size);
        return Err(format!(
            "--by {}: expected a target from {lower:.1} to {upper:.1} {unit}, got {to:.1} {unit} (starting at {from:.1} {unit})",
            arguments.by
        )
        .into());
    }
    let mut pace = FixedRate::new(period)?;
    let patience = by.abs() / speed + GRACE;
    let mut left = patience;
    while let Some(tick) = pace.next_tick(&interrupted) {
        left -= period * (tick.missed + 1) as f64;
        hand.read(&mut state)?;
        let rest = begin + by - state.joints[finger].position[joint];
        if rest * by <= 0.0 || left <= 0.0 {
            break;
        }
        hand.jog(finger, joint, speed * by.signum())?;
    }
    hand.jog(finger, joint, 0.0)?;
    hand.read(&mut state)?;
    let end = state.joints[finger].position[joint];
    let (from, to) = (begin / size, end / size);
    let (in_time, interrupted) = (left > 0.0, interrupted.load(Ordering::Relaxed));
    let why = match in_time {
        true if interrupted => "; interrupted".to_string(),
        true => String::new(),
        false => format!("; timed out after {patience:.1} s"),
    };
    writeln!(
        out,
        "theta{} of finger {finger}{}: from {from:.2} to {to:.2} {unit}{why}",
        joint + 1,
        moved_with(rig, moved)
    )?;
    Ok(match in_time && !interrupted && end != begin {
        true => Outcome::Done,
        false => Outcome::GivenUp,
    })
}
