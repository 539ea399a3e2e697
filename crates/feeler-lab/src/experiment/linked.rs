//! What an experiment means to the programs of a rig that work by it.

use super::{ExperimentError, controller, fingers_at_home, layouts};
use crate::config::Experiment;
use feeler::sensor::made_for::MadeFor;
use feeler_link::network::Network;
use feeler_link::peers::Expected;
use feeler_link::programs::{HandConfig, HandProgram, ProgramError, RigConfig, RigSpeed};
use std::sync::Arc;

/// Why a program of a rig cannot start.
#[derive(Debug, thiserror::Error)]
pub enum LinkedError {
    /// The experiment makes no sense.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The program cannot take part in the link.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

/// What the programs of a rig must agree in.
///
/// # Errors
/// When a fingertip makes no sense.
pub fn expected(experiment: &Experiment) -> Result<Expected, ExperimentError> {
    let config = &experiment.config;
    let hash = |finger| {
        let made_for = MadeFor::fingertip(config.sensor.fingertip(finger));
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
        speed: None,
    })
}

/// The hand program of `experiment` on `network`, whose rig's time goes at `speed`; it commands nothing yet.
///
/// # Errors
/// When a part of the experiment makes no sense, or the network does not listen.
pub fn hand_program(
    experiment: &Experiment,
    speed: RigSpeed,
    network: Arc<dyn Network>,
) -> Result<HandProgram, LinkedError> {
    let config = &experiment.config;
    let layouts = layouts(config)?;
    let (fingers, _) = fingers_at_home(config)?;
    let hand = HandConfig {
        control: config.control.clone(),
        expected: expected(experiment)?,
        elements: layouts.iter().map(|layout| layout.elements.len()).collect(),
        speed,
        time_limit: config.time_limit,
    };
    let controller = controller(experiment, &fingers, &layouts)?;
    Ok(HandProgram::new(&hand, controller, network)?)
}

/// How the rig program of `experiment` works, whose time goes at `speed`.
///
/// # Errors
/// When a fingertip makes no sense.
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
