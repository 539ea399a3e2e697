//! Servos on a bus as the rig of `feeler hand`.

use super::hand::ask_for_real_time;
use super::rig::Arguments;
use crate::drives::check::{Rig, all_changes, write_changes};
use crate::{CommandError, Outcome};
use feeler_console::Warnings;
use feeler_console::watch_for_interrupt;
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

/// Where pseudo-terminals are: what is there is no servo, and keeps the time that it is told to.
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
    // Ends after the program, which switches the torque off.
    let (bus, rig, port) = open(arguments, &experiment, RigClock::at_speed(speed))?;
    let mut program = RigProgram::new(rig, &config, network)?;
    program.set_warn(Warnings::on_stderr().warn());
    if arguments.real_time {
        ask_for_real_time();
    }
    writeln!(
        out,
        "serving the servos of {name} on {port}, which have torque; Ctrl-C ends it"
    )?;
    out.flush()?;
    program.run(&interrupted)?;
    let report = program.report();
    drop(program);
    drop(bus);
    writeln!(out, "{report}\nall torque is off")?;
    Ok(Outcome::Done)
}

/// Seconds of the experiment in a second.
fn speed(arguments: &Arguments) -> Result<f64, CommandError> {
    let RigSpeed::Times(speed) = arguments.speed else {
        let expected = "servos wait for nobody; expected a number";
        return Err(format!("--speed max: {expected}").into());
    };
    let port = arguments.port.as_deref().unwrap_or_default();
    let is_emulated = arguments.drives.is_some() || Path::new(port).starts_with(PSEUDO_TERMINALS);
    if speed != 1.0 && !is_emulated {
        let expected = "servos keep real time; expected 1, --drives emulated, or a --port of `feeler drives emulate`";
        return Err(format!("--speed {speed}: {expected}").into());
    }
    Ok(speed)
}

/// The emulated bus, if it is one; the rig; and its port.
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

/// Says what would be written.
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
        "would set the bus watchdogs of {count} servos on {} to {watchdog} s, give them torque, and serve them as the rig {name} to a hand \
         at {}; nothing was written",
        config.port,
        arguments.link.endpoints().join(", "),
    )?;
    Ok(Outcome::Done)
}
