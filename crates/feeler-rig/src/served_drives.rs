//! Serves servos on a bus as the rig of `feeler hand`.

use crate::drives_check::{ServoRig, all_changes, print_changes};
use crate::real_time::request_real_time;
use crate::session::RigSession;
use feeler_console::{CommandError, Outcome, Warnings, watch_for_interrupt};
use feeler_drives::bus::Bus;
use feeler_drives::config::DrivesConfig;
use feeler_drives::emulator::Emulator;
use feeler_drives::setup::named_servos;
use feeler_drives::{RigClock, TORQUE_MAY_BE_ON};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::rigs::driven::{drives, emulated_bus};
use feeler_lab::experiment::rigs::linked::rig_config;
use feeler_lab::experiment::{BusRig, fingers_at_home, world};
use feeler_link::programs::{RigConfig, RigProgram, RigSpeed};
use feeler_link::security::Right;
use feeler_sim::rig::SimRig;
use std::io::Write;
use std::path::Path;

/// Folder of pseudo-terminals. Servos there are emulated and may run at any speed.
const PSEUDO_TERMINALS: &str = "/dev/pts";

/// Options of a program that serves servos.
#[derive(Debug, Clone)]
pub struct DrivesOptions {
    /// Serial port, or `None` for the experiment's.
    pub port: Option<String>,
    /// `true` to emulate the bus, with servos that move the simulated world.
    pub emulated: bool,
    /// `true` to print the planned changes only, without writing to a servo.
    pub dry_run: bool,
    /// `true` to request real-time scheduling.
    pub real_time: bool,
    /// Speed of the experiment's time relative to real time; other than 1 for emulated servos only.
    pub speed: RigSpeed,
}

/// Serves the servos of the rig to its hand until Ctrl-C.
///
/// # Errors
/// If the options contradict each other, or the bus or the network fails.
pub fn serve_drives(
    session: &RigSession,
    options: &DrivesOptions,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let experiment = &session.experiment;
    let speed = speed(options)?;
    if options.dry_run {
        return plan(session, options, RigClock::at_speed(speed), out);
    }
    let config = RigConfig {
        survives_faults: true,
        ..rig_config(experiment, options.speed)?
    };
    let name = &session.name;
    let network = session.connect(&[Right::Rig])?;
    let interrupted = watch_for_interrupt()?;
    // Closed after torque is disabled.
    let (bus, rig, port) = open(options, experiment, RigClock::at_speed(speed))?;
    let mut program = RigProgram::new(rig, &config, network)?;
    program.set_warn(Warnings::on_stderr().warn());
    if options.real_time {
        request_real_time();
    }
    writeln!(
        out,
        "serving the servos of {name} on {port} with torque enabled; press Ctrl-C to stop"
    )?;
    out.flush()?;
    let ended = program.run(&interrupted).map_err(CommandError::from);
    writeln!(out, "{}", program.report())?;
    let is_off = program.into_rig().disable_torque();
    drop(bus);
    match (ended, is_off) {
        (Ok(()), true) => {
            writeln!(out, "torque is off")?;
            Ok(Outcome::Done)
        }
        (Ok(()), false) => Err(format!(
            "not every servo has confirmed that its torque is off; {TORQUE_MAY_BE_ON}"
        )
        .into()),
        (Err(error), true) => Err(error),
        (Err(error), false) => Err(format!("{error}; {TORQUE_MAY_BE_ON}").into()),
    }
}

/// Returns the speed relative to real time.
fn speed(options: &DrivesOptions) -> Result<f64, CommandError> {
    let RigSpeed::Times(speed) = options.speed else {
        let expected = "servos cannot wait for the hand; expected a number";
        return Err(format!("--speed max: {expected}").into());
    };
    let port = options.port.as_deref().unwrap_or_default();
    let is_emulated = options.emulated || Path::new(port).starts_with(PSEUDO_TERMINALS);
    if speed != 1.0 && !is_emulated {
        let expected = "real servos run in real time; expected 1, --drives emulated, or a --port of `feeler drives emulate`";
        return Err(format!("--speed {speed}: {expected}").into());
    }
    Ok(speed)
}

/// Opens the rig; returns its emulated bus (if emulated), the rig and the name of its port.
fn open(
    options: &DrivesOptions,
    experiment: &Experiment,
    clock: RigClock,
) -> Result<(Option<Emulator>, BusRig, String), CommandError> {
    if options.emulated {
        let (rig, bus) = BusRig::emulated(experiment, clock)?;
        let port = format!("an emulated bus, {}", bus.path());
        return Ok((Some(bus), rig, port));
    }
    let config = ServoRig::new(experiment.clone(), options.port.as_deref())?.config;
    let port = config.port.clone();
    Ok((None, BusRig::open(experiment, config, clock)?, port))
}

/// Prints the planned writes without executing them.
fn plan(
    session: &RigSession,
    options: &DrivesOptions,
    clock: RigClock,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let experiment = &session.experiment;
    let (_bus, config) = match options.emulated {
        true => {
            let rig = SimRig::new(world(experiment)?);
            let bus = emulated_bus(experiment, &rig, clock.clone())?;
            let port = bus.path().to_string();
            let config = drives(experiment);
            (Some(bus), DrivesConfig { port, ..config })
        }
        false => (
            None,
            ServoRig::new(experiment.clone(), options.port.as_deref())?.config,
        ),
    };
    let how = (config.protocol, config.baud_rate);
    let mut bus = Bus::open(&config.port, how, config.reply_timeout, clock)?;
    let (fingers, _) = fingers_at_home(&experiment.config)?;
    print_changes(&all_changes(&mut bus, &config, &fingers)?, out)?;
    let (count, watchdog) = (named_servos(&config).count(), config.bus_watchdog);
    writeln!(
        out,
        "would set the bus watchdogs of {count} servos on {} to {watchdog} s, enable their torque, and serve them as the rig {} to a hand \
         at {}; nothing was written",
        config.port,
        session.name,
        session.link.endpoints().join(", "),
    )?;
    Ok(Outcome::Done)
}
