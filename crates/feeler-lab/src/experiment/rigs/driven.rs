//! Simulated runs whose hand consists of servos on an emulated bus. The servos move the simulated world, in real time
//! or in lockstep with the run.

use super::world_plant::WorldPlant;
use crate::config::Experiment;
use crate::experiment::{ExperimentError, Session, check_shared_servos, fingers_at_home};
use feeler::hand::FingerDescription;
use feeler::pace::{FixedRate, PaceError, Schedule};
use feeler_drives::bus::Bus;
use feeler_drives::config::DrivesConfig;
use feeler_drives::emulator::{Emulator, EmulatorConfig, EmulatorError, Lockstep, Plant};
use feeler_drives::hand::DriveHand;
use feeler_drives::{DriveError, RigClock};
use feeler_sim::rig::SimRig;

/// Minimum reply timeout of emulated servos (s). The emulator is a thread that may be delayed on a busy computer.
const EMULATED_REPLY_TIMEOUT: f64 = 0.1;

/// Error in the setup of a run on an emulated bus.
#[derive(Debug, thiserror::Error)]
pub enum DrivenError {
    /// The experiment cannot be set up.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The servos cannot be used.
    #[error("drives: {0}")]
    Drives(#[from] DriveError),
    /// The emulated bus cannot be started.
    #[error("drives: {0}")]
    Emulator(#[from] EmulatorError),
    /// The control period is invalid.
    #[error("control.period: {0}")]
    Period(#[from] PaceError),
}

/// Returns the servos to be emulated for `experiment`: those of its table `[drives]`, or defaults for its hand.
pub fn drives(experiment: &Experiment) -> DrivesConfig {
    let config = &experiment.config;
    let own = config.drives.clone();
    let own = own.unwrap_or_else(|| {
        let fingers = config.hand.finger.iter();
        let prismatic: Vec<_> = fingers.map(FingerDescription::is_prismatic).collect();
        DrivesConfig::emulated(&prismatic)
    });
    DrivesConfig {
        reply_timeout: own.reply_timeout.max(EMULATED_REPLY_TIMEOUT),
        ..own
    }
}

/// Starts an emulated bus with the servos of `experiment`, which move the simulated world of `rig` in the time of
/// `clock`.
///
/// # Errors
/// If a part of the experiment is invalid, or the system has no pseudo-terminal.
pub fn emulated_bus(
    experiment: &Experiment,
    rig: &SimRig,
    clock: RigClock,
) -> Result<Emulator, EmulatorError> {
    let (bus, plant) = servos(experiment, rig);
    Emulator::start(&bus, plant, clock)
}

/// Returns the servos of `experiment`, and the simulated world that they move.
fn servos(experiment: &Experiment, rig: &SimRig) -> (EmulatorConfig, Box<dyn Plant>) {
    let config = drives(experiment);
    let bus = EmulatorConfig::of(&config, experiment.config.seed);
    (bus, Box::new(WorldPlant::new(rig.clone(), &config)))
}

/// The emulated bus of a run, which must live as long as the run.
pub enum EmulatedBus {
    /// On a pseudo-terminal. The factor is the speed relative to real time.
    Terminal(Emulator, f64),
    /// In the simulated time of the run.
    Lockstep(Lockstep),
}

impl EmulatedBus {
    /// Creates a schedule with steps every `period` seconds of the bus's time, starting now.
    ///
    /// # Errors
    /// If the period is invalid.
    pub fn schedule(&self, period: f64) -> Result<Box<dyn Schedule>, PaceError> {
        Ok(match self {
            Self::Terminal(_, speed) => Box::new(FixedRate::new(period / speed)?),
            Self::Lockstep(bus) => Box::new(FixedRate::with_clock(period, bus.clone())?),
        })
    }

    /// Returns `true` if the bus runs in real time.
    pub fn is_paced(&self) -> bool {
        matches!(self, Self::Terminal(..))
    }
}

/// Sets up a run of `experiment` over an emulated bus, and returns the bus, too. Time runs `speed` times as fast as
/// real time. An infinite speed runs in lockstep, as fast as possible and deterministically.
///
/// # Errors
/// If a part of the experiment is invalid, or its servos cannot be used.
pub fn session(experiment: &Experiment, speed: f64) -> Result<(Session, EmulatedBus), DrivenError> {
    let config = &experiment.config;
    let (fingers, _) = fingers_at_home(config)?;
    check_shared_servos(config)?;
    let session = Session::new(experiment)?;
    let drives = drives(experiment);
    let how = (drives.protocol, drives.baud_rate);
    let (bus, master) = if speed.is_finite() {
        let clock = RigClock::at_speed(speed);
        let emulator = emulated_bus(experiment, session.rig(), clock.clone())?;
        let master = Bus::open(emulator.path(), how, drives.reply_timeout, clock);
        let master = master.map_err(DriveError::from)?;
        (EmulatedBus::Terminal(emulator, speed), master)
    } else {
        let (bus, plant) = servos(experiment, session.rig());
        let bus = Lockstep::new(&bus, plant);
        let port = Box::new(bus.clone());
        let master = Bus::on(port, how, drives.reply_timeout, bus.clock());
        (EmulatedBus::Lockstep(bus), master)
    };
    let control = &config.control;
    let most_age = control.stale_periods * control.period;
    let hand = DriveHand::on(master, &drives, &fingers, most_age)?;
    // The session's original hand is dropped: only the servos advance the world.
    let session = session.with_hand(Box::new(hand), control.stale_periods as u64);
    Ok((session, bus))
}
