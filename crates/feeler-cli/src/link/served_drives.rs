//! Servos on a bus as the rig of `feeler hand`.

use super::hand::ask_for_real_time;
use super::rig::Arguments;
use crate::drives::check::{Rig, all_changes, write_changes};
use crate::interrupt::watch_for_interrupt;
use crate::warnings::Warnings;
use crate::{CommandError, Outcome};
use feeler_drives::bus::Bus;
use feeler_drives::clock::RigClock;
use feeler_drives::config::DrivesConfig;
use feeler_drives::emulator::Emulator;
use feeler_drives::setup::named_joints;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::driven::{drives, emulated_bus};
use feeler_lab::experiment::driven_rig::DrivenRig;
use feeler_lab::experiment::linked::rig_config;
use feeler_lab::experiment::world;
use feeler_link::programs::{RigConfig, RigProgram, RigSpeed};
use feeler_link::right::Right;
use feeler_sim::rig::SimRig;
use std::io::Write;
use std::path::Path;

/// Folder of pseudo-terminals. Servos there are emulated and may run at any speed.
const PSEUDO_TERMINALS: &str = "/dev/pts";

pub fn serve(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.values.settings())?;
    let speed = speed(arguments)?;
    if arguments.dry_run {
        return plan(arguments, &experiment, RigClock::at_speed(speed), out);
    }
    let config = RigConfig {
        survives_faults: true,
        ..rig_config(&experiment, arguments.speed)?
    };
    let name = arguments.values.rig(&experiment);
    let network = arguments.link.with_right(&[Right::Rig])?.connect(&name)?;
    let interrupted = watch_for_interrupt()?;
    // Dropped after the program, which disables torque.
    let (bus, rig, port) = open(arguments, &experiment, RigClock::at_speed(speed))?;
    let mut program = RigProgram::new(rig, &config, network)?;
    program.set_warn(Warnings::on_stderr().warn());
    if arguments.real_time {
        ask_for_real_time();
    }
    writeln!(
        out,
        "serving the servos of {name} on {port} with torque enabled; press Ctrl-C to stop"
    )?;
    out.flush()?;
    program.run(&interrupted)?;
    let report = program.report();
    drop(program);
    drop(bus);
    writeln!(out, "{report}\ntorque is off")?;
    Ok(Outcome::Done)
}

/// Returns the speed relative to real time.
fn speed(arguments: &Arguments) -> Result<f64, CommandError> {
    let RigSpeed::Times(speed) = arguments.speed else {
        let expected = "servos cannot wait for the hand; expected a number";
        return Err(format!("--speed max: {expected}").into());
    };
    let port = arguments.port.as_deref().unwrap_or_default();
    let is_emulated = arguments.drives.is_some() || Path::new(port).starts_with(PSEUDO_TERMINALS);
    if speed != 1.0 && !is_emulated {
        let expected = "real servos run in real time; expected 1, --drives emulated, or a --port of `feeler drives emulate`";
        return Err(format!("--speed {speed}: {expected}").into());
    }
    Ok(speed)
}

/// Opens the rig; returns its emulated bus (if emulated), the rig and the name of its port.
fn open(
    arguments: &Arguments,
    experiment: &Experiment,
    clock: RigClock,
) -> Result<(Option<Emulator>, DrivenRig, String), CommandError> {
    if arguments.drives.is_some() {
        let (rig, bus) = DrivenRig::emulated(experiment, clock)?;
        let port = format!("an emulated bus, {}", bus.path());
        return Ok((Some(bus), rig, port));
    }
    let config = Rig::of(experiment.clone(), arguments.port.as_deref())?.config;
    let port = config.port.clone();
    Ok((None, DrivenRig::open(experiment, config, clock)?, port))
}

/// Prints the planned writes without executing them.
fn plan(
    arguments: &Arguments,
    experiment: &Experiment,
    clock: RigClock,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let (_bus, config) = match arguments.drives {
        Some(_) => {
            let rig = SimRig::new(world(experiment)?);
            let bus = emulated_bus(experiment, &rig, clock.clone())?;
            let port = bus.path().to_string();
            let config = drives(experiment);
            (Some(bus), DrivesConfig { port, ..config })
        }
        None => (
            None,
            Rig::of(experiment.clone(), arguments.port.as_deref())?.config,
        ),
    };
    let how = (config.protocol, config.baud_rate);
    let mut bus = Bus::open(&config.port, how, config.reply_timeout, clock)?;
    write_changes(&all_changes(&mut bus, &config)?, out)?;
    let (count, watchdog) = (named_joints(&config).count(), config.bus_watchdog);
    let name = arguments.values.rig(experiment);
    writeln!(
        out,
        "would set the bus watchdogs of {count} servos on {} to {watchdog} s, enable their torque, and serve them as the rig {name} to a hand \
         at {}; nothing was written",
        config.port,
        arguments.link.endpoints().join(", "),
    )?;
    Ok(Outcome::Done)
}
