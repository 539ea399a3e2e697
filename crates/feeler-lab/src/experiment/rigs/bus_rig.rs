//! A rig of servos on a bus, operated by other programs.

use super::sim_rig_server::ServedSensing;
use crate::config::Experiment;
use crate::experiment::rigs::driven::{DrivenError, drives, emulated_bus};
use crate::experiment::{check_shared_servos, fingers_at_home, rig};
use feeler::hand::{FingerGeometry, Hand, HandCommand, HandError, HandState, JointVector};
use feeler::sensor::forces::SensorError;
use feeler_drives::config::DrivesConfig;
use feeler_drives::emulator::Emulator;
use feeler_drives::hand::DriveHand;
use feeler_drives::{DriveError, RigClock};
use feeler_link::messages::message::InstrumentsMessage;
use feeler_link::programs::{Rig, SensorOutput};

/// A rig of servos. The motors are powered while it exists.
pub struct BusRig {
    config: DrivesConfig,
    fingers: Vec<FingerGeometry>,
    most_age: f64,
    clock: RigClock,
    /// `None` if the bus was closed and could not be reopened.
    hand: Option<DriveHand>,
    /// Position of each joint before the bus was closed, rad or m.
    positions: Vec<f64>,
    stop: HandCommand,
    time: f64,
    /// Simulated sensors of the world that emulated servos move. `None` for real servos.
    sensing: Option<ServedSensing>,
}

impl BusRig {
    /// Opens the bus of `config` and powers the servos of `experiment`. The cameras belong to other programs.
    ///
    /// # Errors
    /// If a finger is invalid, or a servo is in an unexpected state.
    pub fn open(
        experiment: &Experiment,
        config: DrivesConfig,
        clock: RigClock,
    ) -> Result<Self, DrivenError> {
        let control = &experiment.config.control;
        let (fingers, _) = fingers_at_home(&experiment.config)?;
        check_shared_servos(&experiment.config)?;
        let mut rig = Self {
            config,
            stop: HandCommand::stop(fingers.len()),
            fingers,
            most_age: control.stale_periods * control.period,
            clock,
            hand: None,
            positions: Vec::new(),
            time: 0.0,
            sensing: None,
        };
        rig.hand = Some(rig.open_hand()?);
        Ok(rig)
    }

    /// Like [`Self::open`], but on an emulated bus whose servos move the simulated world, and with the simulated
    /// sensors of this world. Also returns the bus, which must live as long as the rig.
    ///
    /// # Errors
    /// If a part of the experiment is invalid, or the system has no pseudo-terminal.
    pub fn emulated(
        experiment: &Experiment,
        clock: RigClock,
    ) -> Result<(Self, Emulator), DrivenError> {
        let (_, joints) = fingers_at_home(&experiment.config)?;
        let (world, cap) = rig(experiment, &joints)?;
        let sensing = ServedSensing::new(experiment, &world, cap)?;
        let bus = emulated_bus(experiment, &world, clock.clone())?;
        let config = DrivesConfig {
            port: bus.path().into(),
            ..drives(experiment)
        };
        let mut driven = Self::open(experiment, config, clock)?;
        driven.sensing = Some(sensing);
        Ok((driven, bus))
    }

    /// Disables the torque of all servos. Returns `true` if every servo confirms it; otherwise, motors may still be
    /// powered.
    pub fn disable_torque(&mut self) -> bool {
        let hand = self.hand.as_mut();
        hand.is_some_and(|hand| hand.disable_torque().is_ok())
    }

    fn open_hand(&self) -> Result<DriveHand, DriveError> {
        let clock = self.clock.clone();
        DriveHand::open(&self.config, &self.fingers, self.most_age, clock)
    }
}

fn without_power() -> HandError {
    HandError::Failed("the servos have no power".into())
}

impl Rig for BusRig {
    fn finger_count(&self) -> usize {
        self.fingers.len()
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError> {
        let hand = self.hand.as_mut().ok_or_else(without_power)?;
        hand.read(state)?;
        self.time = state.stamp;
        Ok(self.sensing.as_mut().map(ServedSensing::instruments))
    }

    fn expose(&mut self, finger: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
        match &mut self.sensing {
            Some(sensing) => sensing.expose(finger),
            None => Ok(None),
        }
    }

    /// Commands the servos. Stops them instead if the latest joint angles are too old because the computer is late;
    /// this is not a fault of the servos.
    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        let hand = self.hand.as_mut().ok_or_else(without_power)?;
        let stopped = JointVector::default();
        let moves = command.joint_velocity().iter().any(|v| *v != stopped);
        match moves && hand.age() > self.most_age {
            true => hand.command(&self.stop),
            false => hand.command(command),
        }
    }

    /// Releases the servos and reopens the bus, in case the cable was pulled or a servo was replaced. Servos that an
    /// overload has switched off are restarted.
    fn restart(&mut self) -> Result<(), HandError> {
        if let Some(mut hand) = self.hand.take() {
            // If the bus has failed, opening it reports the cause.
            let _ = hand.restart_overloaded();
            self.positions = hand.angles().map(|(_, position)| position).collect();
        }
        let reopened = self.open_hand().and_then(|hand| {
            hand.check_turns(&self.positions)?;
            Ok(hand)
        });
        self.hand = Some(reopened.map_err(|error| HandError::Failed(error.to_string()))?);
        Ok(())
    }
}
