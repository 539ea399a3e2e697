//! The `feeler drives emulate` subcommand.

use super::EmulateArguments;
use super::bus_log::BusLog;
use crate::typed::given_and_typed;
use crate::{CommandError, Outcome};
use feeler_console::{Outputs, watch_for_interrupt};
use feeler_drives::RigClock;
use feeler_drives::emulator::{
    BusFault, EmulatedServo, Emulator, EmulatorConfig, LagPlant, LogEntry,
};
use feeler_drives::packet::Protocol;
use feeler_drives::registers::MODELS;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::rigs::driven;
use feeler_lab::experiment::world;
use feeler_sim::rig::SimRig;
use std::io::{Write, stderr};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// Interval between checks whether to stop.
const NAP: Duration = Duration::from_millis(50);
/// Time constant of servos without a simulated load (s); assumed.
const LAG: f64 = 0.015;

pub fn emulate(arguments: &EmulateArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let (faults, typed) = given_and_typed("fault", &arguments.faults)?;
    let experiment = arguments.experiment.as_deref();
    let mut outputs = Outputs::new(arguments.overwrite.force, [experiment.map(Path::new)]);
    let log = arguments.log.as_deref();
    let log = log.map(|path| outputs.create(path, "--log")).transpose()?;
    let mut log = log.map(BusLog::new).transpose()?;
    let interrupted = watch_for_interrupt()?;
    let clock = RigClock::at_speed(arguments.speed);
    let emulator = match experiment {
        Some(name) => {
            let experiment = Experiment::load(name, &arguments.settings)?;
            let rig = SimRig::new(world(&experiment)?);
            driven::emulated_bus(&experiment, &rig, clock)?
        }
        None => alone(arguments, clock)?,
    };
    for fault in faults {
        inject(&emulator, fault).map_err(|error| format!("--fault: {error}"))?;
    }
    writeln!(out, "{}", emulator.path())?;
    out.flush()?;
    while !interrupted.load(Ordering::Relaxed) {
        std::thread::sleep(NAP);
        for fault in typed.iter().flat_map(Receiver::try_iter) {
            if let Err(error) = inject(&emulator, fault) {
                // If standard error is closed, the fault is ignored silently.
                let _ = writeln!(stderr(), "invalid fault: {error}");
            }
        }
        if let Some(log) = &mut log {
            log.write(&said(&emulator))?;
        }
    }
    if let Some(mut log) = log {
        log.write(&said(&emulator))?;
        log.finish()?;
    }
    Ok(Outcome::Done)
}

/// Injects `fault`.
///
/// # Errors
/// If it affects a servo that the bus does not have.
fn inject(emulator: &Emulator, fault: BusFault) -> Result<(), String> {
    let ids: Vec<_> = emulator.servos().servos().iter().map(|s| s.id).collect();
    match fault.servo().filter(|id| !ids.contains(id)) {
        None => {
            emulator.inject(fault);
            Ok(())
        }
        Some(id) => Err(format!(
            "the bus has no servo {id}: expected one of the ids {ids:?}"
        )),
    }
}

/// Returns the packets since the last call.
fn said(emulator: &Emulator) -> Vec<LogEntry> {
    emulator.servos().take_log()
}

/// Emulates unloaded servos, each in the middle of its first turn or of its range.
fn alone(arguments: &EmulateArguments, clock: RigClock) -> Result<Emulator, CommandError> {
    let mut protocols = Protocol::ALL.into_iter();
    let protocol = protocols.find(|known| known.name() == arguments.protocol);
    let protocol = protocol.ok_or("unknown protocol")?;
    let name = match protocol {
        Protocol::Dynamixel => "XL330-M288",
        Protocol::Feetech => "STS3215",
        Protocol::FeetechScs => "SCS0009",
    };
    let model = MODELS.iter().find(|model| model.name == name);
    let model = model.ok_or("unknown servo model")?;
    let config = EmulatorConfig {
        protocol,
        baud_rate: arguments.baud_rate,
        servos: (1..=arguments.servos)
            .map(|id| EmulatedServo::new(id, model))
            .collect(),
        noise: 0.3,
        seed: 0,
    };
    let plant = LagPlant::new(LAG, &vec![model.range / 2.0; arguments.servos.into()]);
    Ok(Emulator::start(&config, Box::new(plant), clock)?)
}
