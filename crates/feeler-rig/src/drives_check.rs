//! Checks of the servos of a rig.

use feeler::hand::FingerGeometry;
use feeler_console::{CommandError, Outcome};
use feeler_drives::bus::Bus;
use feeler_drives::config::{DrivesConfig, JointDriveConfig};
use feeler_drives::registers::DriveMode;
use feeler_drives::setup::{
    Change, changes, check_fast_sync_read, check_model, check_velocity_limit, is_torque_on,
    joints_of_servo, named_servos, read_angles, read_health, servo_range,
};
use feeler_drives::{DriveError, JointName, RigClock};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::fingers_at_home;
use std::io::Write;

/// An experiment whose hand has servos on a bus.
pub struct ServoRig {
    /// Experiment.
    pub experiment: Experiment,
    /// Servos of its hand.
    pub config: DrivesConfig,
    /// Geometry of each finger.
    pub fingers: Vec<FingerGeometry>,
}

impl ServoRig {
    /// Creates the rig of `experiment`, with `port` in place of its serial port if given.
    ///
    /// # Errors
    /// If the experiment has no table `[drives]` or an invalid finger.
    pub fn new(experiment: Experiment, port: Option<&str>) -> Result<Self, CommandError> {
        let (fingers, _) = fingers_at_home(&experiment.config)?;
        let Some(mut config) = experiment.config.drives.clone() else {
            let name = &experiment.config.name;
            return Err(format!(
                "{name}: expected a table [drives] that describes the servos (see docs/drives.md)"
            )
            .into());
        };
        if let Some(port) = port {
            config.port = port.into();
        }
        Ok(Self {
            experiment,
            config,
            fingers,
        })
    }

    /// Opens the bus.
    ///
    /// # Errors
    /// If the port cannot be opened.
    pub fn open(&self) -> Result<Bus, CommandError> {
        let config = &self.config;
        let how = (config.protocol, config.baud_rate);
        Ok(Bus::open(
            &config.port,
            how,
            config.reply_timeout,
            RigClock::real(),
        )?)
    }
}

/// Reads model, settings, velocity limit, health and angle of all servos and prints them with the changes that a run would
/// make. Writes nothing to a servo. If `dry_run`, opens no port and prints what would be read.
///
/// # Errors
/// If the bus fails or `out` cannot be written. A faulty servo is [`Outcome::GivenUp`].
pub fn check_servos(
    rig: &ServoRig,
    dry_run: bool,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let config = &rig.config;
    writeln!(
        out,
        "{} at {} Bd, {}",
        config.port,
        config.baud_rate,
        config.protocol.name()
    )?;
    if dry_run {
        for (joint, drive) in named_servos(config) {
            writeln!(
                out,
                "would read model, settings, velocity limit, health and position of {joint}, a {}; writes nothing",
                drive.model
            )?;
        }
        return Ok(Outcome::Done);
    }
    let mut bus = rig.open()?;
    let (mut problems, mut planned) = (0, Vec::new());
    for (joint, drive) in named_servos(config) {
        let mut checked = check_servo(&mut bus, config, &rig.fingers, (joint, drive));
        // Reading again is harmless. A disturbed line or a busy computer loses a reply now and then; that is not the
        // servo's fault.
        if let Err(error @ DriveError::Servo { .. }) = &checked {
            writeln!(out, "{error}; retrying")?;
            checked = check_servo(&mut bus, config, &rig.fingers, (joint, drive));
        }
        match checked {
            Ok((positions, changes)) => {
                let (model, mode) = (&drive.model, mode(drive));
                writeln!(out, "{joint}: {model}{mode}, ok, at {positions}")?;
                planned.extend(changes);
            }
            Err(error @ DriveError::Bus(_)) => return Err(error.into()),
            Err(error) => {
                problems += 1;
                writeln!(out, "{error}")?;
            }
        }
    }
    print_changes(&planned, out)?;
    if problems > 0 {
        writeln!(out, "{problems} servos failed the check")?;
        return Ok(Outcome::GivenUp);
    }
    writeln!(out, "all servos passed the check")?;
    Ok(Outcome::Done)
}

/// Describes the mode of `drive`; empty for velocity mode.
fn mode(drive: &JointDriveConfig) -> String {
    match (drive.mode(), drive.most_current()) {
        (DriveMode::Velocity, _) => String::new(),
        (DriveMode::CurrentLimitedPosition, Some(most)) => {
            format!(" in {} mode, at most {most} A", drive.mode().name())
        }
        (mode, _) => format!(" in {} mode", mode.name()),
    }
}

/// Returns the unit in which the joint of `drive` is displayed, and its size in rad or m: degrees, or millimetres for a
/// prismatic joint.
pub fn display_unit(drive: &JointDriveConfig) -> (&'static str, f64) {
    match drive.travel_per_turn {
        None => ("deg", 1f64.to_radians()),
        Some(_) => ("mm", 1e-3),
    }
}

/// Checks one servo. Returns the positions of its joints as text, with a note if its torque is on, and the required
/// setting changes.
fn check_servo(
    bus: &mut Bus,
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
    (joint, drive): (JointName, &JointDriveConfig),
) -> Result<(String, Vec<Change>), DriveError> {
    let range = servo_range(config, fingers, joint)?;
    let changes = changes(bus, joint, drive, range)?;
    let model = check_model(bus, joint, drive)?;
    if config.fast_sync_read {
        check_fast_sync_read(bus, joint, model)?;
    }
    check_velocity_limit(bus, config, fingers, (joint, model))?;
    read_health(bus, joint)?.check(config.protocol, joint, &config.health_limits())?;
    let angles = read_angles(bus, config, fingers, joint)?;
    let mut positions = String::new();
    for ((moved, drive), angle) in joints_of_servo(config, joint.id).zip(angles) {
        let (unit, size) = display_unit(drive);
        if moved != joint {
            let (number, finger) = (moved.joint + 1, moved.finger);
            positions.push_str(&format!(", with theta{number} of finger {finger} at "));
        }
        positions.push_str(&format!("{:.2} {unit}", angle / size));
    }
    if is_torque_on(bus, joint)? {
        positions.push_str(", torque is on");
    }
    Ok((positions, changes))
}

/// Returns the register changes that a program makes on `bus` before it enables the torque of the servos of `config`,
/// which move these `fingers`.
///
/// # Errors
/// If a servo does not answer, is of another model, or cannot reach the range of its joint.
pub fn all_changes(
    bus: &mut Bus,
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
) -> Result<Vec<Change>, DriveError> {
    let mut planned = Vec::new();
    for (joint, drive) in named_servos(config) {
        let range = servo_range(config, fingers, joint)?;
        planned.extend(changes(bus, joint, drive, range)?);
    }
    Ok(planned)
}

/// Prints the register changes that a run makes before it enables torque.
///
/// # Errors
/// If `out` cannot be written.
pub fn print_changes(changes: &[Change], out: &mut dyn Write) -> Result<(), CommandError> {
    for change in changes {
        let Change {
            joint,
            register,
            from,
            to,
        } = change;
        let (name, address) = (register.name, register.address);
        writeln!(
            out,
            "{joint}: a run will set {name} (address {address}) from {from} to {to}"
        )?;
    }
    Ok(())
}
