//! A recording put through the sensor stage, the control stage or both again, and compared bit for bit.

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
use feeler::control::control_loop::ControlLoop;
use feeler::control::controller::Controller;
use feeler_record::{
    InstrumentRecord, RecordedCamera, RecordedHand, Recorder, Recording, RunLog, Tactile,
};
use outside::Outside;
use recorded_touch::RecordedTouch;
use std::iter::Peekable;
use std::path::Path;
use std::vec::IntoIter;

/// Where a replay's forces come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplayFrom<'a> {
    /// From the pictures in this file, which is the one that the recording was read from.
    Frames(&'a Path),
    /// From the record.
    Forces,
}

/// A replay under way.
pub struct Replay<'a> {
    recording: &'a Recording,
    control_loop: ControlLoop<Sensor, RecordedHand>,
    log: RunLog<Comparer<'a>>,
    outside: Peekable<IntoIter<(usize, Outside)>>,
    step: usize,
    steps: usize,
}

/// The experiment in `recording`, with its calibrations, its policy and `settings` of the form
/// `control.slip_threshold=2.5` put in.
///
/// # Errors
/// When its text makes no sense, or a value is out of its range.
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
    /// Puts `recording` through `experiment`: as recorded, or with other settings.
    ///
    /// # Errors
    /// When there is nothing to replay, or the experiment is not of the recording's rig.
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
            log: RunLog::new(comparer, &recording.facts)?,
            outside: outside::on_record(recording, &as_recorded)?
                .into_iter()
                .peekable(),
            step: 0,
            steps: steps(recording),
        })
    }

    /// Writes what comes out to `recorder`, too.
    ///
    /// # Errors
    /// When the constants on record make no sense.
    pub fn copy_to(self, recorder: Recorder) -> Result<Self, ReplayError> {
        let mut comparer = self.log.into_recorder();
        comparer.copy = Some(recorder);
        let log = RunLog::new(comparer, &self.recording.facts)?;
        Ok(Self { log, ..self })
    }

    /// Goes round the control loop once on the next step on record.
    ///
    /// # Errors
    /// When the record is at its end, a sensor fails, or the copy cannot be written.
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

    /// The controller, as of the newest step.
    pub fn controller(&self) -> &Controller {
        self.control_loop.controller()
    }

    /// Whether the record is at its end.
    pub fn finished(&self) -> bool {
        self.step >= self.steps
    }

    /// Steps on record.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// How it compares, and the copy.
    pub fn finish(self) -> (Comparison, Option<Recorder>) {
        let comparer = self.log.into_recorder();
        (comparer.comparison, comparer.copy)
    }
}

/// `experiment`, which is not as recorded: the joints on record follow the commands on record, not those that other
/// settings give.
fn unfollowed(experiment: &Experiment) -> Experiment {
    let mut experiment = experiment.clone();
    experiment.config.control.monitor.joint_deviation = 0.0;
    experiment
}

/// Control steps that are whole: of a recording that was cut off, the last may not be. What comes after a gap does not
/// follow from what is on record before it.
fn steps(recording: &Recording) -> usize {
    let fingers = recording.fingers.iter().flat_map(|finger| {
        [
            finger.tactile.len(),
            finger.flags.len(),
            finger.joints.len(),
            finger.command.len(),
        ]
    });
    fingers.fold(recording.steps_in_a_row(), usize::min)
}

/// Refuses what a replay cannot change: how many fingers and elements there are, and how often they are
/// looked at.
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

/// One sensor per finger that feels what is on record.
fn recorded_forces(recording: &Recording, experiment: &Experiment) -> Vec<Sensor> {
    let thresholds = experiment.config.control.thresholds();
    let sensor = |finger| Box::new(RecordedTouch::new(recording, finger, thresholds)) as Sensor;
    (0..recording.fingers.len()).map(sensor).collect()
}

/// One sensor per finger that looks at the pictures on record in `file`.
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

/// The control stage of `experiment` over `sensors` and the hand on record.
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
