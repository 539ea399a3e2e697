//! Configuration of the programs of a distributed rig from an experiment.

use crate::config::Experiment;
use crate::experiment::{
    ExperimentError, controller, fingers_at_home, following_controller, layouts,
};
use feeler::control::Controller;
use feeler::control::task::follow::Requests;
use feeler::hand::FingerDescription;
use feeler::sensor::fingertip::CalibrationTarget;
use feeler_link::inboxes::Expected;
use feeler_link::messages::JointCounts;
use feeler_link::programs::{HandConfig, HandProgram, ProgramError, RigConfig, RigSpeed};
use feeler_link::transport::Network;
use std::sync::Arc;

/// Error that prevents a program of a rig from starting.
#[derive(Debug, thiserror::Error)]
pub enum LinkedError {
    /// The experiment is invalid.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The program cannot connect to the other programs of the rig.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

/// Returns the values on which all programs of a rig must agree.
///
/// # Errors
/// If a fingertip is invalid.
pub fn expected(experiment: &Experiment) -> Result<Expected, ExperimentError> {
    let config = &experiment.config;
    let hash = |finger| {
        let made_for = CalibrationTarget::fingertip(config.sensor.fingertip(finger));
        made_for
            .map(|made_for| made_for.sha256)
            .map_err(|source| ExperimentError::Sensor {
                finger,
                source: Box::new(source.into()),
            })
    };
    Ok(Expected {
        experiment: experiment.sha256(),
        fingertips: (0..config.hand.finger.len())
            .map(hash)
            .collect::<Result<_, _>>()?,
        joints: JointCounts::new(
            config
                .hand
                .finger
                .iter()
                .map(FingerDescription::joint_count),
        ),
        speed: None,
    })
}

/// Creates the hand program of `experiment` on `network`. `speed` is the speed of the rig's time. The program does
/// not send commands yet.
///
/// # Errors
/// If a part of the experiment is invalid, or the network cannot be used.
pub fn hand_program(
    experiment: &Experiment,
    speed: RigSpeed,
    network: Arc<dyn Network>,
) -> Result<HandProgram, LinkedError> {
    let config = &experiment.config;
    let (fingers, _) = fingers_at_home(config)?;
    let controller = controller(experiment, &fingers, &layouts(config)?)?;
    program(experiment, controller, config.time_limit, speed, network)
}

/// Like [`hand_program`], but the hand follows `requests` without a time limit instead of executing the experiment's task.
/// They expire after `lifetime` (s).
///
/// # Errors
/// As [`hand_program`].
pub fn following_program(
    experiment: &Experiment,
    requests: &Requests,
    lifetime: f64,
    speed: RigSpeed,
    network: Arc<dyn Network>,
) -> Result<HandProgram, LinkedError> {
    let controller = following_controller(experiment, requests, lifetime)?;
    program(experiment, controller, f64::INFINITY, speed, network)
}

/// Creates a hand program with a controller and a time limit (s).
fn program(
    experiment: &Experiment,
    controller: Controller,
    time_limit: f64,
    speed: RigSpeed,
    network: Arc<dyn Network>,
) -> Result<HandProgram, LinkedError> {
    let config = &experiment.config;
    let layouts = layouts(config)?;
    let hand = HandConfig {
        control: config.control.clone(),
        expected: expected(experiment)?,
        elements: layouts.iter().map(|layout| layout.elements.len()).collect(),
        speed,
        time_limit,
    };
    Ok(HandProgram::new(&hand, controller, network)?)
}

/// Returns the configuration of the rig program of `experiment`. `speed` is the speed of the rig's time.
///
/// # Errors
/// If a fingertip is invalid.
pub fn rig_config(experiment: &Experiment, speed: RigSpeed) -> Result<RigConfig, ExperimentError> {
    let control = &experiment.config.control;
    Ok(RigConfig {
        expected: expected(experiment)?,
        period: control.period,
        stale_periods: control.stale_periods,
        speed,
        survives_faults: false,
    })
}
