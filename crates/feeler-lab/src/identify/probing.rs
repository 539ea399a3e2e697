//! Set-up and simulation of probing runs.

use super::IdentifyError;
use super::trace::Trace;
use crate::config::{Experiment, ExperimentConfig};
use crate::experiment::{Pictures, Session};
use feeler::control::Phase;
use feeler::control::law::LawConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::probe::ProbeConfig;

/// Replaces the screw task of an experiment by a probe along the same paths. An experiment whose task is already a
/// probe is returned unchanged.
///
/// # Errors
/// If the experiment has another task, or the resulting experiment is invalid.
pub fn probing(experiment: &Experiment) -> Result<Experiment, IdentifyError> {
    let config = &experiment.config;
    let screw = match &config.task {
        TaskConfig::Probe(_) => return Ok(experiment.clone()),
        TaskConfig::Screw(screw) => screw,
        other => return Err(IdentifyError::NoRectangle { task: other.name() }),
    };
    let probe = ProbeConfig {
        search_limit: screw.search_limit,
        ..ProbeConfig::gentle(screw.finger.clone(), config.control.over_force)
    };
    let mut probing = ExperimentConfig {
        task: TaskConfig::Probe(probe),
        ..config.clone()
    };
    probing.control.law = LawConfig::default();
    Ok(experiment.with_config(probing)?)
}

/// Simulates a probing run of `experiment`, which [`probing`] returned.
///
/// # Errors
/// If the run cannot be set up, fails, or stops before the routine is complete.
pub fn probe(experiment: &Experiment) -> Result<Trace, IdentifyError> {
    let config = &experiment.config;
    let probe = probe_of(config)?;
    let mut session = Session::rendering(experiment, Pictures::Sensed)?;
    let mut trace = Trace::new(probe, &config.control, session.layouts());
    while !session.finished() {
        session.step()?;
        trace.push(session.control_loop());
    }
    let controller = session.control_loop().controller();
    match controller.stop_reason() {
        Some(reason) => Err(IdentifyError::Stopped {
            reason: reason.clone(),
        }),
        None if controller.phase() != Phase::Done => Err(IdentifyError::TimeOver {
            limit: config.time_limit,
        }),
        None => Ok(trace),
    }
}

fn probe_of(config: &ExperimentConfig) -> Result<&ProbeConfig, IdentifyError> {
    match &config.task {
        TaskConfig::Probe(probe) => Ok(probe),
        other => Err(IdentifyError::NoRectangle { task: other.name() }),
    }
}
