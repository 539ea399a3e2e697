//! The `feeler drives jog` subcommand.

use super::{JogArguments, JointArguments};
use crate::{CommandError, Outcome};
use feeler::hand::{Hand, HandState};
use feeler::pace::{FixedRate, Schedule};
use feeler_console::watch_for_interrupt;
use feeler_drives::config::JointDriveConfig;
use feeler_drives::hand::DriveHand;
use feeler_drives::setup::{jog_speed, joints_of_servo, named_joints, servo_range};
use feeler_drives::{DriveError, JointName, RigClock, TORQUE_MAY_BE_ON};
use feeler_rig::{ServoRig, all_changes, display_unit, print_changes};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// Maximum angle of a jog (deg, or mm of a prismatic joint).
pub(super) const MOST: f64 = 10.0;
/// Time (s) that a joint may take in addition to the time computed from its speed. Servos with coarse encoders and
/// friction move only when the goal is several counts away, which takes a slow joint two seconds.
pub(super) const GRACE: f64 = 3.0;

pub fn jog(arguments: &JogArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let rig = arguments.rig.load()?;
    let (joint, drive) = joint_drive(&rig, arguments.joint.place())?;
    let (unit, size) = display_unit(drive);
    let by = arguments.by;
    if by.is_nan() || by == 0.0 || by.abs() > MOST {
        return Err(format!(
            "--by {by}: expected a value other than 0, at most {MOST} {unit} in either direction"
        )
        .into());
    }
    check_distance(&rig, by, (joint, drive))?;
    check_speed(&rig, arguments.speed, (joint, drive))?;
    if arguments.rig.dry_run {
        return plan(&rig, arguments, (joint, unit), out);
    }
    move_joint(&rig, arguments, joint, (unit, size), out)
}

/// Checks a `speed` of `joint`, in its display unit per second.
pub(super) fn check_speed(
    rig: &ServoRig,
    speed: f64,
    (joint, drive): (JointName, &JointDriveConfig),
) -> Result<(), CommandError> {
    let (unit, size) = display_unit(drive);
    let most = jog_speed(&rig.config, &rig.fingers, (joint, drive))? / size;
    // Rounding must not refuse the maximum.
    if !(speed > 0.0 && speed <= most * (1.0 + 1e-9)) {
        return Err(format!(
            "--speed {speed}: expected a speed of theta{} of finger {}{} above 0, at most {most:.1} {unit}/s",
            joint.joint + 1,
            joint.finger,
            moved_with(rig, joint)
        )
        .into());
    }
    Ok(())
}

/// Checks the distances of the other joints that the servo of `drive` moves, if it moves `joint` by a distance in its
/// display unit.
pub(super) fn check_distance(
    rig: &ServoRig,
    by: f64,
    (joint, drive): (JointName, &JointDriveConfig),
) -> Result<(), CommandError> {
    let (_, size) = display_unit(drive);
    let others = joints_of_servo(&rig.config, joint.id).filter(|(name, _)| *name != joint);
    for (name, other) in others {
        let (unit, other_size) = display_unit(other);
        let moves = (other.ratio_to(drive) * by * size / other_size).abs();
        // Rounding must not refuse joints that move alike.
        if moves > MOST * (1.0 + 1e-9) {
            return Err(format!(
                "--by {by}: expected at most {MOST:.1} {unit} of theta{} of finger {}, which the servo moves by {moves:.1} {unit}",
                name.joint + 1,
                name.finger
            )
            .into());
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
        "would enable torque of all servos, move theta{joint} of finger {finger}{} by {by} {unit} at {speed} {unit}/s, and disable torque; nothing was written",
        moved_with(rig, moved)
    )?;
    Ok(Outcome::Done)
}

/// Moves the joint, and prints its final position in `unit`, whose size is given in rad or m.
fn move_joint(
    rig: &ServoRig,
    arguments: &JogArguments,
    moved: JointName,
    (unit, size): (&'static str, f64),
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let control = &rig.experiment.config.control;
    let (period, most_age) = (control.period, control.stale_periods * control.period);
    let patience = arguments.by.abs() / arguments.speed + GRACE;
    let interrupted = watch_for_interrupt()?;
    let jog = Jog {
        rig,
        arguments,
        joint: moved,
        unit: (unit, size),
        period,
        patience,
        interrupted: &interrupted,
    };
    let mut hand = DriveHand::open(&rig.config, &rig.fingers, most_age, RigClock::real())?;
    let motion = jog.run(&mut hand);
    let Motion {
        begin,
        end,
        in_time,
    } = motion.map_err(|error| disable_torque_after(&mut hand, error))?;
    let (from, to) = (begin / size, end / size);
    let interrupted = interrupted.load(Ordering::Relaxed);
    let why = match in_time {
        true if interrupted => "; interrupted".to_string(),
        true => String::new(),
        false => format!("; timed out after {patience:.1} s"),
    };
    writeln!(
        out,
        "theta{} of finger {}{}: from {from:.2} to {to:.2} {unit}{why}",
        moved.joint + 1,
        moved.finger,
        moved_with(rig, moved)
    )?;
    Ok(match in_time && !interrupted && end != begin {
        true => Outcome::Done,
        false => Outcome::GivenUp,
    })
}

/// Slow motion of a joint.
struct Jog<'a> {
    rig: &'a ServoRig,
    arguments: &'a JogArguments,
    joint: JointName,
    /// Display unit, and its size in rad or m.
    unit: (&'static str, f64),
    /// Control period, s.
    period: f64,
    /// Maximum duration, s.
    patience: f64,
    interrupted: &'a AtomicBool,
}

/// Motion of a jogged joint.
struct Motion {
    /// Position before and after it, rad or m.
    begin: f64,
    end: f64,
    /// `false` if the time ran out.
    in_time: bool,
}

impl Jog<'_> {
    /// Moves the joint until it arrives, the time runs out, or the user interrupts it.
    fn run(&self, hand: &mut DriveHand) -> Result<Motion, CommandError> {
        let JointName { finger, joint, .. } = self.joint;
        let mut state = HandState::zero(self.rig.fingers.len());
        hand.read(&mut state)?;
        let begin = state.joints[finger].position[joint];
        let (_, size) = self.unit;
        let JogArguments { by, speed, .. } = *self.arguments;
        let target = begin + by * size;
        self.check_target(begin, target)?;
        let velocity = speed * size * by.signum();
        let mut pace = FixedRate::new(self.period)?;
        let mut left = self.patience;
        while let Some(tick) = pace.next_tick(self.interrupted) {
            left -= self.period * (tick.missed + 1) as f64;
            hand.read(&mut state)?;
            let rest = target - state.joints[finger].position[joint];
            if rest * velocity <= 0.0 || left <= 0.0 {
                break;
            }
            hand.jog(finger, joint, velocity)?;
        }
        hand.jog(finger, joint, 0.0)?;
        hand.read(&mut state)?;
        Ok(Motion {
            begin,
            end: state.joints[finger].position[joint],
            in_time: left > 0.0,
        })
    }

    /// Checks that all joints of the servo are within their limits if the joint moves from `begin` to `target` (rad or m).
    fn check_target(&self, begin: f64, target: f64) -> Result<(), CommandError> {
        let (lower, upper) = servo_range(&self.rig.config, &self.rig.fingers, self.joint)?;
        if (lower..=upper).contains(&target) {
            return Ok(());
        }
        let (by, (unit, size)) = (self.arguments.by, self.unit);
        let [lower, upper, from, to] = [lower, upper, begin, target].map(|end| end / size);
        Err(format!(
            "--by {by}: expected a target from {lower:.1} to {upper:.1} {unit}, got {to:.1} {unit} (starting at {from:.1} {unit})"
        )
        .into())
    }
}

/// Disables the torque of `hand` after an `error`, and adds to the error if this may have failed.
pub(super) fn disable_torque_after(hand: &mut DriveHand, error: CommandError) -> CommandError {
    match hand.disable_torque() {
        Ok(()) => error,
        Err(_) => format!("{error}; {TORQUE_MAY_BE_ON}").into(),
    }
}
