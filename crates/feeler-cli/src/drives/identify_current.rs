//! The `feeler drives identify-current` subcommand.

use super::jog::{
    GRACE, MOST, check_distance, check_speed, disable_torque_after, joint_drive, moved_with,
};
use super::output::NewExperiment;
use super::{IdentifyArguments, JointArguments};
use crate::typed::typed_lines;
use crate::{CommandError, Outcome};
use feeler::hand::{Hand, HandState};
use feeler::pace::{FixedRate, Schedule};
use feeler_console::watch_for_interrupt;
use feeler_drives::config::{JointDriveConfig, TorqueCalibration};
use feeler_drives::hand::DriveHand;
use feeler_drives::registers::{DriveMode, Registers};
use feeler_drives::setup::{joints_of_servo, servo_range};
use feeler_drives::torque::{TorqueSample, identify_torque};
use feeler_drives::{JointName, RigClock, TORQUE_MAY_BE_ON};
use feeler_rig::{ServoRig, all_changes, display_unit, print_changes};
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, TryRecvError};

/// Fraction of a sweep, from its start, that is excluded from the mean because of static friction and backlash.
const SETTLES: f64 = 0.3;

pub fn identify(
    arguments: &IdentifyArguments,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let mut rig = arguments.rig.load()?;
    let place = arguments.joint.place();
    let (joint, drive) = joint_drive(&rig, place)?;
    check_first_joint(&rig, joint, drive)?;
    if Registers::of(rig.config.protocol).current.is_none() {
        return Err(format!(
            "{joint}: expected a servo that measures its current; {} servos measure none",
            rig.config.protocol.name()
        )
        .into());
    }
    set_velocity_mode(&mut rig, joint);
    let (joint, drive) = joint_drive(&rig, place)?;
    let (unit, size) = display_unit(drive);
    let by = arguments.by;
    if !(by > 0.0 && by <= MOST) {
        return Err(format!("--by {by}: expected above 0, at most {MOST} {unit}").into());
    }
    check_distance(&rig, by, (joint, drive))?;
    check_speed(&rig, arguments.speed, (joint, drive))?;
    let loads = &arguments.loads;
    if !loads.iter().all(|load| load.is_finite()) || loads.iter().all(|&load| load == loads[0]) {
        return Err("--loads: expected at least two different numbers".into());
    }
    let file = NewExperiment::create(&arguments.output, &arguments.rig, &arguments.overwrite)?;
    if arguments.rig.dry_run {
        return plan(&rig, arguments, (joint, unit), out);
    }
    let mut sweeps = Sweeps::new(&rig, arguments, joint, size)?;
    let samples = sweeps.measure(&arguments.loads, out);
    let samples = samples.map_err(|error| disable_torque_after(&mut sweeps.hand, error))?;
    if samples.is_some() {
        let returned = sweeps.return_to_start();
        returned.map_err(|error| disable_torque_after(&mut sweeps.hand, error))?;
    }
    let is_off = sweeps.hand.disable_torque().is_ok();
    drop(sweeps);
    let Some(samples) = samples else {
        let torque = if is_off {
            "torque is off"
        } else {
            TORQUE_MAY_BE_ON
        };
        writeln!(out, "interrupted; {torque}")?;
        return Ok(Outcome::GivenUp);
    };
    let found =
        identify_torque(&samples, drive.effort_unit()).map_err(|error| error.to_string())?;
    let setting = setting(place, &found);
    report(&found, drive, out)?;
    match file {
        Some(file) => file.write(&rig, &[setting], out)?,
        None => writeln!(out, "set {setting}, or write it with --output FILE")?,
    }
    Ok(Outcome::Done)
}

/// Checks that `joint` is the first joint of its servo, to which the calibration of the servo refers.
fn check_first_joint(
    rig: &ServoRig,
    joint: JointName,
    drive: &JointDriveConfig,
) -> Result<(), CommandError> {
    let first = joints_of_servo(&rig.config, joint.id).find(|(_, drive)| !drive.shared);
    match (drive.shared, first) {
        (true, Some((first, _))) => {
            let (number, finger) = (first.joint + 1, first.finger);
            Err(format!(
                "{joint}: expected the first joint of the servo; load only theta{number} of finger {finger}, with --finger {finger} --joint {number}"
            )
            .into())
        }
        _ => Ok(()),
    }
}

/// Sets the servo of `joint` to velocity mode for the sweeps. In the position modes the motor moves in a step per control
/// period, and its current falls from the start of each step to its end, where it is read: the friction would be
/// underestimated. The next run sets the servo's mode again.
fn set_velocity_mode(rig: &mut ServoRig, joint: JointName) {
    let drives = &mut rig.config.finger[joint.finger].joint[joint.joint];
    drives.mode = Some(DriveMode::Velocity);
    drives.leash = None;
}

/// Prints the planned writes without executing them.
fn plan(
    rig: &ServoRig,
    arguments: &IdentifyArguments,
    (moved, unit): (JointName, &str),
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let planned = all_changes(&mut rig.open()?, &rig.config, &rig.fingers)?;
    print_changes(&planned, out)?;
    let IdentifyArguments {
        by, speed, sweeps, ..
    } = arguments;
    let JointArguments { finger, joint } = arguments.joint;
    writeln!(
        out,
        "would enable torque of all servos, sweep theta{joint} of finger {finger}{} by {by} {unit} to either side at {speed} {unit}/s, {sweeps} times per direction and load, and disable torque; nothing was written",
        moved_with(rig, moved)
    )?;
    Ok(Outcome::Done)
}

/// Prints the calibration of `drive`.
fn report(
    found: &TorqueCalibration,
    drive: &JointDriveConfig,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    let unit = drive.effort_unit();
    let name = match drive.travel_per_turn {
        None => "torque",
        Some(_) => "force",
    };
    writeln!(
        out,
        "{name} constant {:.4} +- {:.4} {unit}/A, friction {:.4} +- {:.4} {unit} (standard errors)",
        found.constant, found.constant_error, found.friction, found.friction_error
    )?;
    Ok(())
}

/// Formats the calibration of a joint as an experiment setting, `KEY=VALUE`.
fn setting((finger, joint): (usize, usize), found: &TorqueCalibration) -> String {
    format!(
        "drives.finger.{finger}.joint.{joint}.torque={{ constant = {:.6}, constant_error = {:.6}, friction = {:.6}, friction_error = {:.6} }}",
        found.constant, found.constant_error, found.friction, found.friction_error
    )
}

/// Sweeps of one joint.
struct Sweeps {
    hand: DriveHand,
    state: HandState,
    pace: FixedRate,
    /// Control period, s.
    period: f64,
    interrupted: Arc<AtomicBool>,
    place: (usize, usize),
    /// Ends of a sweep, rad or m.
    ends: [f64; 2],
    /// Speed of a sweep, rad/s or m/s.
    speed: f64,
    /// Number of sweeps per direction and load.
    count: u8,
    /// Unit of the loads.
    unit: &'static str,
}

impl Sweeps {
    /// Opens the hand and enables torque. `size` is the unit of the arguments (rad or m).
    fn new(
        rig: &ServoRig,
        arguments: &IdentifyArguments,
        moved: JointName,
        size: f64,
    ) -> Result<Self, CommandError> {
        let control = &rig.experiment.config.control;
        let most_age = control.stale_periods * control.period;
        let interrupted = watch_for_interrupt()?;
        let mut hand = DriveHand::open(&rig.config, &rig.fingers, most_age, RigClock::real())?;
        hand.read_currents();
        let mut state = HandState::zero(rig.fingers.len());
        hand.read(&mut state)?;
        let JointName { finger, joint, .. } = moved;
        let middle = state.joints[finger].position[joint];
        let drive = &rig.config.finger[finger].joint[joint];
        let ends = [-1.0, 1.0].map(|side| middle + side * arguments.by * size);
        let (lower, upper) = servo_range(&rig.config, &rig.fingers, moved)?;
        if ends[0] < lower || ends[1] > upper {
            let (unit, _) = display_unit(drive);
            let [lower, upper, from, to] = [lower, upper, ends[0], ends[1]].map(|end| end / size);
            return Err(format!(
                "--by {}: expected a sweep within {lower:.1} to {upper:.1} {unit}, got {from:.1} to {to:.1} {unit}; move the joint away from its limit",
                arguments.by,
            )
            .into());
        }
        Ok(Self {
            hand,
            state,
            pace: FixedRate::new(control.period)?,
            period: control.period,
            interrupted,
            place: (finger, joint),
            ends,
            speed: arguments.speed * size,
            count: arguments.sweeps,
            unit: drive.effort_unit(),
        })
    }

    /// Measures sweeps under each of `loads`. Returns `None` if interrupted.
    fn measure(
        &mut self,
        loads: &[f64],
        out: &mut dyn Write,
    ) -> Result<Option<Vec<TorqueSample>>, CommandError> {
        let lines = typed_lines::<String>("line");
        let mut samples = Vec::new();
        for &load in loads {
            writeln!(
                out,
                "apply a load of {load} {} against positive motion, then press Enter",
                self.unit
            )?;
            out.flush()?;
            if !self.hold_until_enter(&lines)? || self.sweep(-1.0)?.is_none() {
                return Ok(None);
            }
            for _ in 0..self.count {
                for direction in [1.0, -1.0] {
                    let Some(current) = self.sweep(direction)? else {
                        return Ok(None);
                    };
                    let sign = if direction > 0.0 { '+' } else { '-' };
                    writeln!(
                        out,
                        "load {load} {}, direction {sign}: {current:.4} A",
                        self.unit
                    )?;
                    samples.push(TorqueSample {
                        load,
                        direction,
                        current,
                    });
                }
            }
        }
        Ok(Some(samples))
    }

    /// Waits for the next period and reads the hand. Returns the number of periods that have passed, or `None` if
    /// interrupted.
    fn step(&mut self) -> Result<Option<u64>, CommandError> {
        let Some(tick) = self.pace.next_tick(&self.interrupted) else {
            return Ok(None);
        };
        self.hand.read(&mut self.state)?;
        Ok(Some(tick.missed + 1))
    }

    /// Holds the hand until a line arrives. Returns `false` if interrupted or if the input has ended.
    fn hold_until_enter(&mut self, lines: &Receiver<String>) -> Result<bool, CommandError> {
        let (finger, joint) = self.place;
        while self.step()?.is_some() {
            self.hand.jog(finger, joint, 0.0)?;
            match lines.try_recv() {
                Ok(_) => return Ok(true),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => return Ok(false),
            }
        }
        Ok(false)
    }

    /// Moves the joint from the lower end to the middle, where it was before the first sweep.
    fn return_to_start(&mut self) -> Result<(), CommandError> {
        let (finger, joint) = self.place;
        let middle = (self.ends[0] + self.ends[1]) / 2.0;
        let mut left = (middle - self.ends[0]) / self.speed + GRACE;
        while left > 0.0 && self.state.joints[finger].position[joint] < middle {
            let Some(periods) = self.step()? else { break };
            left -= periods as f64 * self.period;
            self.hand.jog(finger, joint, self.speed)?;
        }
        Ok(self.hand.jog(finger, joint, 0.0)?)
    }

    /// Moves the joint to the end in `direction`. Returns the mean current of the later part of the way, A, or `None` if
    /// interrupted.
    fn sweep(&mut self, direction: f64) -> Result<Option<f64>, CommandError> {
        let (finger, joint) = self.place;
        let [lower, upper] = self.ends;
        let end = if direction > 0.0 { upper } else { lower };
        let way = upper - lower;
        let mut left = way / self.speed + GRACE;
        let (mut sum, mut count) = (0.0, 0_u32);
        loop {
            let Some(periods) = self.step()? else {
                return Ok(None);
            };
            let rest = (end - self.state.joints[finger].position[joint]) * direction;
            if rest <= 0.0 {
                break;
            }
            left -= periods as f64 * self.period;
            if left < 0.0 {
                return Err("the joint did not arrive in time: expected free motion; reduce the load or increase the current limit".into());
            }
            if rest < (1.0 - SETTLES) * way {
                let mut currents = self.hand.currents();
                let current = currents.find(|(name, _)| (name.finger, name.joint) == self.place);
                sum += current.map_or(0.0, |(_, current)| current);
                count += 1;
            }
            self.hand.jog(finger, joint, self.speed * direction)?;
        }
        self.hand.jog(finger, joint, 0.0)?;
        Ok(Some(sum / f64::from(count)))
    }
}
