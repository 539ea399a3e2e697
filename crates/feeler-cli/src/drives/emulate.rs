//! `feeler drives emulate`

use super::EmulateArguments;
use crate::interrupt::watch_for_interrupt;
use crate::{CommandError, Outcome};
use feeler_drives::clock::RigClock;
use feeler_drives::emulator::{BusFault, EmulatedServo, Emulator, EmulatorConfig, LagPlant};
use feeler_drives::packet::Protocol;
use feeler_drives::registers::MODELS;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{driven, world};
use feeler_sim::rig::SimRig;
use std::io::Write;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// How often it is looked whether to end.
const NAP: Duration = Duration::from_millis(50);
/// Time constant of servos that move nothing else, s; assumed.
const LAG: f64 = 0.015;

pub fn emulate(arguments: &EmulateArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let faults = arguments.faults.iter().map(|fault| fault.parse());
    let faults = faults.collect::<Result<Vec<BusFault>, _>>();
    let faults = faults.map_err(|error| format!("--fault {error}"))?;
    let interrupted = watch_for_interrupt()?;
    let emulator = match &arguments.experiment {
        Some(name) => {
            let experiment = Experiment::load(name, &arguments.settings)?;
            let rig = SimRig::new(world(&experiment)?);
            driven::emulated_bus(&experiment, &rig, RigClock::real())?
        }
        None => alone(arguments)?,
    };
    for fault in faults {
        emulator.inject(fault);
    }
    writeln!(out, "{}", emulator.path())?;
    out.flush()?;
    while !interrupted.load(Ordering::Relaxed) {
        std::thread::sleep(NAP);
    }
    Ok(Outcome::Done)
}

/// Servos that move nothing but themselves, in the middle of their first turn.
fn alone(arguments: &EmulateArguments) -> Result<Emulator, CommandError> {
    let (protocol, name) = match arguments.protocol.as_str() {
        "feetech" => (Protocol::Feetech, "STS3215"),
        _ => (Protocol::Dynamixel, "XL330-M288"),
    };
    let model = MODELS.iter().find(|model| model.name == name);
    let model = model.ok_or("no such model")?;
    let config = EmulatorConfig {
        protocol,
        baud_rate: arguments.baud_rate,
        servos: (1..=arguments.servos)
            .map(|id| EmulatedServo::new(id, model))
            .collect(),
        noise: 0.3,
        seed: 0,
    };
    let plant = LagPlant::new(LAG, &vec![std::f64::consts::PI; arguments.servos.into()]);
    Ok(Emulator::start(&config, Box::new(plant), RigClock::real())?)
}
