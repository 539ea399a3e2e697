//! Replays a recording through the sensor stage, the control stage or both, and compares the results bit by bit.

mod compare;
mod error;
mod fields;
mod outside;
mod recorded_touch;

pub use compare::{Comparison, Difference, Kind, Tally};
pub use error::ReplayError;

use super::sensors::optical_sensor;
use super::{Sensor, controller, fingers_at_home, layouts};
use crate::config::{ConfigError, Experiment};
use compare::Comparer;
use feeler::control::{ControlLoop, Controller};
use feeler_record::{
    InstrumentRecord, RecordError, RecordedCamera, RecordedHand, Recorder, Recording, RunLog,
    Tactile,
};
use outside::Outside;
use recorded_touch::RecordedTouch;
use std::iter::Peekable;
use std::path::Path;
use std::vec::IntoIter;

/// Source of the forces in a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplayFrom<'a> {
    /// Recorded images in this file, which must be the file of the recording.
    Frames(&'a Path),
    /// Recorded forces.
    Forces,
}

/// An active replay.
pub struct Replay<'a> {
    recording: &'a Recording,
    control_loop: ControlLoop<Sensor, RecordedHand>,
    log: RunLog<Comparer<'a>>,
    outside: Peekable<IntoIter<(usize, Outside)>>,
    step: usize,
    steps: usize,
}

/// Returns the experiment of `recording` with its calibrations and its policy, and with `settings` of the form
/// `control.slip_threshold=2.5` applied.
///
/// # Errors
/// If its text is invalid, or a value is out of range.
pub fn recorded_experiment(
    recording: &Recording,
    settings: &[String],
) -> Result<Experiment, ConfigError> {
    let text = &recording.experiment;
    let experiment = Experiment::parse(text, "the experiment on record", settings, None)?;
    let experiment = experiment.with_calibrations(recording.calibrations.clone());
    Ok(experiment.with_policy(recording.policy.clone()))
}

impl<'a> Replay<'a> {
    /// Prepares a replay of `recording` with `experiment`, whose settings may differ from the recorded ones.
    ///
    /// # Errors
    /// If the recording is empty, or the experiment describes another rig.
    pub fn new(
        recording: &'a Recording,
        from: ReplayFrom<'_>,
        experiment: &Experiment,
    ) -> Result<Self, ReplayError> {
        let as_recorded = recorded_experiment(recording, &[])?;
        check_rig(recording, experiment)?;
        check_rig(recording, &as_recorded)?;
        let sensors = match from {
            ReplayFrom::Frames(file) => optical_sensors(recording, experiment, file)?,
            ReplayFrom::Forces => recorded_forces(recording, experiment),
        };
        let of_frames = matches!(from, ReplayFrom::Frames(_));
        let comparer = Comparer::new(recording, of_frames);
        let other = experiment.config != as_recorded.config;
        let followed = if other {
            unfollowed(experiment)
        } else {
            experiment.clone()
        };
        Ok(Self {
            recording,
            control_loop: control_loop(recording, &followed, sensors)?,
            log: log(comparer, recording)?,
            outside: outside::on_record(recording, &as_recorded)?
                .into_iter()
                .peekable(),
            step: 0,
            steps: steps(recording),
        })
    }

    /// Also writes the results to `recorder`.
    ///
    /// # Errors
    /// If the recorded constants are invalid.
    pub fn copy_to(self, recorder: Recorder) -> Result<Self, ReplayError> {
        let mut comparer = self.log.into_recorder();
        comparer.copy = Some(recorder);
        let log = log(comparer, self.recording)?;
        Ok(Self { log, ..self })
    }

    /// Executes one control step with the next recorded input.
    ///
    /// # Errors
    /// If the recording is exhausted, a sensor fails, or the copy cannot be written.
    pub fn step(&mut self) -> Result<(), ReplayError> {
        let step = self.step;
        while let Some((_, outside)) = self.outside.next_if(|(at, _)| *at == step) {
            outside.apply(self.control_loop.controller_mut());
        }
        self.control_loop.step()?;
        let instruments = InstrumentRecord {
            torque: self.recording.torque_sensor.get(step),
            cap: self.recording.cap.get(step),
            slip: self.recording.true_slip.get(step),
            object: None,
        };
        self.log.write(&self.control_loop, instruments)?;
        self.step += 1;
        Ok(())
    }

    /// Returns the controller after the latest step.
    pub fn controller(&self) -> &Controller {
        self.control_loop.controller()
    }

    /// Returns `true` if all recorded steps were replayed.
    pub fn finished(&self) -> bool {
        self.step >= self.steps
    }

    /// Number of recorded steps.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Returns the result of the comparison, and the copy.
    pub fn finish(self) -> (Comparison, Option<Recorder>) {
        let comparer = self.log.into_recorder();
        (comparer.comparison, comparer.copy)
    }
}

/// Creates the log of a replay of `recording`, which contains the same messages.
fn log<'a>(
    comparer: Comparer<'a>,
    recording: &Recording,
) -> Result<RunLog<Comparer<'a>>, RecordError> {
    let log = RunLog::new(comparer, &recording.facts)?;
    Ok(match recording.has_efforts() {
        true => log.with_efforts(),
        false => log,
    })
}

/// Returns `experiment` without the monitor of joint deviations: the recorded joints follow the recorded commands, not
/// those that result from other settings.
fn unfollowed(experiment: &Experiment) -> Experiment {
    let mut experiment = experiment.clone();
    experiment.config.control.monitor.joint_deviation = 0.0;
    experiment
}

/// Number of complete consecutive control steps. The last step of a truncated recording may be incomplete, and steps
/// after a gap do not follow from the steps before it.
fn steps(recording: &Recording) -> usize {
    let fingers = recording.fingers.iter().flat_map(|finger| {
        [
            finger.tactile.len(),
            finger.flags.len(),
            finger.joints.len(),
            finger.command.len(),
        ]
    });
    fingers.fold(recording.leading_complete_steps(), usize::min)
}

/// Rejects settings that a replay cannot change: the numbers of fingers and elements, and the control period.
fn check_rig(recording: &Recording, experiment: &Experiment) -> Result<(), ReplayError> {
    if steps(recording) == 0 {
        return Err(ReplayError::NoSteps);
    }
    let same = |what: &str, expected: f64, actual: f64| {
        let other = ReplayError::OtherRig {
            what: what.into(),
            expected: expected.to_string(),
            actual: actual.to_string(),
        };
        (expected == actual).then_some(()).ok_or(other)
    };
    let (facts, config) = (&recording.facts, &experiment.config);
    let fingers = config.hand.finger.len();
    same("hand.finger: fingers", facts.fingers as f64, fingers as f64)?;
    let period = facts.control_period;
    same("control.period (s)", period, config.control.period)?;
    let layouts = layouts(config)?;
    for (finger, (record, layout)) in recording.fingers.iter().zip(&layouts).enumerate() {
        let elements = layout.elements.len() as f64;
        let other = |frame: &&Tactile| frame.forces.len() != layout.elements.len();
        if let Some(frame) = record.tactile.iter().find(other) {
            let what = format!("sensor.fingertip.layout: elements of finger {finger}");
            same(&what, frame.forces.len() as f64, elements)?;
        }
    }
    Ok(())
}

/// Creates one sensor per finger that returns the recorded forces.
fn recorded_forces(recording: &Recording, experiment: &Experiment) -> Vec<Sensor> {
    let thresholds = experiment.config.control.thresholds();
    let sensor = |finger| Box::new(RecordedTouch::new(recording, finger, thresholds)) as Sensor;
    (0..recording.fingers.len()).map(sensor).collect()
}

/// Creates one sensor per finger that evaluates the recorded images in `file`.
fn optical_sensors(
    recording: &Recording,
    experiment: &Experiment,
    file: &Path,
) -> Result<Vec<Sensor>, ReplayError> {
    let fingers = recording.fingers.iter().enumerate();
    fingers
        .map(|(finger, record)| -> Result<Sensor, ReplayError> {
            if record.pictures.is_empty() {
                return Err(ReplayError::NoPictures { finger });
            }
            let camera = RecordedCamera::open(file, recording, finger)?;
            Ok(optical_sensor(experiment, finger, camera)?)
        })
        .collect()
}

/// Creates the control loop of `experiment` with `sensors` and the recorded hand.
fn control_loop(
    recording: &Recording,
    experiment: &Experiment,
    sensors: Vec<Sensor>,
) -> Result<ControlLoop<Sensor, RecordedHand>, ReplayError> {
    let config = &experiment.config;
    let (fingers, _) = fingers_at_home(config)?;
    let controller = controller(experiment, &fingers, &layouts(config)?)?;
    let hand = RecordedHand::new(recording);
    Ok(ControlLoop::new(sensors, hand, controller))
}
