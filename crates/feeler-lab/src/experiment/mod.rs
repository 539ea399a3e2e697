//! Runs in one process: connects the simulated rig, its sensors, the control loop and the recorder.

pub(crate) mod facts;
mod in_memory;
pub(crate) mod instruments;
pub mod live;
pub(crate) mod prefetching_sensor;
pub mod recorded_run;
pub mod replay;
pub(crate) mod reported_recorder;
pub mod rigs;
pub mod run_folder;
pub(crate) mod sample_and_hold;
pub(crate) mod sensors;
pub(crate) mod shared_servos;
pub mod slip_bench;
pub(crate) mod solids;
pub(crate) mod specimen;
pub(crate) mod supervised;
pub(crate) mod truth;
pub(crate) mod warnings;

#[cfg(target_os = "linux")]
pub use crate::experiment::rigs::bus_rig::BusRig;
pub use crate::experiment::rigs::sim_rig_server::SimRigServer;
pub use shared_servos::{SharedServoError, check_shared_servos};
pub use truth::Truth;
pub use warnings::warnings;

use crate::config::{ConfigError, Experiment, ExperimentConfig, Sensing};
pub(crate) use facts::{cap_facts, true_section};
pub use facts::{following_facts, run_facts};
pub use instruments::Instruments;

use facts::simulated_facts;
use feeler::control::law::open_loop::{OpenLoop, OpenLoopConfig};
use feeler::control::law::{Law, LawError};
use feeler::control::task::Task;
use feeler::control::task::follow::{FollowTask, Requests};
use feeler::control::{
    ControlConfig, ControlError, ControlLoop, Controller, Phase, StopReason, TactileSource,
};
use feeler::hand::{
    FingerError, FingerGeometry, Hand, JointVector, KinematicsError, inverse_kinematics,
};
use feeler::pace::{Schedule, Tick};
use feeler::sensor::fingertip::{ElementLayout, Fingertip, FingertipError};
use feeler::sensor::forces::SensingError;
use feeler_drives::DriveError;
use feeler_record::{RecordError, RunFacts};
use feeler_sim::error::SimError;
use feeler_sim::optics::OpticsError;
use feeler_sim::rig::{SimHand, SimRig};
use feeler_sim::world::World;
use glam::DVec3;
use prefetching_sensor::PrefetchingSensor;
use sample_and_hold::FrameCounter;
use specimen::{SpecimenError, check_specimen};
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::{io, thread};
use supervised::InstrumentedRun;
use truth::SlipMeter;

/// Error in the setup or a step of a run.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The experiment file or its calibration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A finger is invalid.
    #[error("hand.finger[{finger}]{}{source}", separator(source))]
    Finger {
        /// Index of the finger.
        finger: usize,
        /// Error of the finger's geometry.
        source: FingerError,
    },
    /// A finger cannot reach its home position.
    #[error("task.{task}.finger[{finger}].home = {home:?} cannot be reached: {source}")]
    Home {
        /// Name of the task.
        task: &'static str,
        /// Index of the finger.
        finger: usize,
        /// Home position in W (m).
        home: [f64; 3],
        /// Reason from the inverse kinematics.
        source: Box<KinematicsError>,
    },
    /// The number of home positions differs from the number of fingers.
    #[error("expected {expected} homes, one for each finger, got {actual}")]
    Homes {
        /// Number of fingers.
        expected: usize,
        /// Number of home positions.
        actual: usize,
    },
    /// A fingertip is invalid.
    #[error("sensor.fingertip: finger {finger}: {source}")]
    Fingertip {
        /// Index of the finger.
        finger: usize,
        /// Error of the fingertip.
        source: FingertipError,
    },
    /// The optics are invalid.
    #[error("sim.optics: {0}")]
    Optics(#[from] OpticsError),
    /// The simulated world cannot be built.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The finger of a friction scan cannot press on a specimen.
    #[error(transparent)]
    Specimen(#[from] SpecimenError),
    /// A sensor cannot be built.
    #[error("sensor: finger {finger}: {source}")]
    Sensor {
        /// Index of the finger.
        finger: usize,
        /// Error of the sensor.
        source: Box<SensingError>,
    },
    /// The system cannot create a thread for a sensor.
    #[error("failed to create a sensor thread: {0}")]
    Thread(io::Error),
    /// The servos cannot be used.
    #[error("drives: {0}")]
    Drives(#[from] DriveError),
    /// A servo cannot move joints of two fingers together.
    #[error("drives: {0}")]
    SharedServo(#[from] SharedServoError),
    /// The control law cannot be built.
    #[error("control.law: {0}")]
    Law(#[from] LawError),
    /// A control cycle failed.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// A message could not be recorded.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// Source of tactile readings for one finger, of any kind.
pub type Sensor = Box<dyn TactileSource + Send>;

/// The simulated hand, or drives that move the simulated world.
pub type AnyHand = Box<dyn Hand + Send>;

/// The control loop of a simulated rig.
pub type SimulatedLoop = ControlLoop<Sensor, AnyHand>;

/// Part of each image that simulated cameras render.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pictures {
    /// Whole images, for recording or display.
    Whole,
    /// Only the sensed pixels, about half of an image. The sensor readings are bit-identical.
    Sensed,
}

/// An active run.
pub struct Session {
    rig: SimRig,
    control_loop: SimulatedLoop,
    layouts: Vec<ElementLayout>,
    /// Index of the object with a thread.
    cap: Option<usize>,
    slip: SlipMeter,
    time_limit: f64,
    /// Maximum number of consecutive missed periods.
    max_missed: u64,
    /// Number of frames taken by the sensor of finger 0. Stays 0 if a frame is taken in every control period.
    #[cfg_attr(not(target_os = "linux"), expect(dead_code))]
    taken: FrameCounter,
    /// `true` if the world advances independently of the steps.
    is_driven: bool,
    /// `true` if the hand follows the requests of another program.
    follows_requests: bool,
}

impl Session {
    /// Sets up a run of `experiment`, with the fingers at their home positions and the cap open.
    ///
    /// # Errors
    /// If a part of the experiment is invalid.
    pub fn new(experiment: &Experiment) -> Result<Self, ExperimentError> {
        Self::rendering(experiment, Pictures::Whole)
    }

    /// Like [`Self::new`], but renders only the requested part of each image.
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn rendering(experiment: &Experiment, pictures: Pictures) -> Result<Self, ExperimentError> {
        let task = &experiment.config.task;
        Self::with_task_rendering(experiment, task.task(), &task.homes(), pictures)
    }

    /// Like [`Self::new`], but with `task` in place of the experiment's task. The fingers start from `homes` (m, in
    /// `W`).
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn with_task(
        experiment: &Experiment,
        task: Box<dyn Task>,
        homes: &[[f64; 3]],
    ) -> Result<Self, ExperimentError> {
        Self::with_task_rendering(experiment, task, homes, Pictures::Whole)
    }

    /// Like [`Self::with_task`], but renders only the requested part of each image.
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn with_task_rendering(
        experiment: &Experiment,
        task: Box<dyn Task>,
        homes: &[[f64; 3]],
        pictures: Pictures,
    ) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        let layouts = layouts(config)?;
        let (fingers, joints) = fingers_at(config, homes)?;
        let mut controller = Controller::with_task(control(experiment)?, task, &fingers, &layouts)?;
        controller.set_couplings(config.couplings());
        let (rig, cap) = rig(experiment, &joints)?;
        check_specimen(config, &fingers, &rig.world())?;
        let taken = FrameCounter::default();
        let sensors = sensors::sensors(experiment, &rig, &layouts, pictures, &taken)?;
        let slip = SlipMeter::new(rig.world().state(), config.simulation()?.frame_period);
        let hand = SimHand::new(rig.clone(), steps_per_command(config)?);
        let hand: AnyHand = Box::new(hand);
        Ok(Self {
            rig,
            control_loop: ControlLoop::new(sensors, hand, controller),
            layouts,
            cap,
            slip,
            time_limit: config.time_limit,
            // Simulated time waits for the steps, so missed periods do not matter.
            max_missed: u64::MAX,
            taken,
            is_driven: false,
            follows_requests: false,
        })
    }

    /// Like [`Self::new`], but the hand follows `requests` without a time limit instead of executing the experiment's
    /// task. They expire after `lifetime` (s).
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn following(
        experiment: &Experiment,
        requests: &Requests,
        lifetime: f64,
    ) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        let task = FollowTask::new(requests.clone(), geometries(config)?, lifetime);
        let homes = config.task.homes();
        let task = Box::new(task);
        let mut session = Self::with_task_rendering(experiment, task, &homes, Pictures::Sensed)?;
        session.set_laws(|_| planned_velocity());
        session.time_limit = f64::INFINITY;
        session.follows_requests = true;
        Ok(session)
    }

    /// Takes and evaluates the images of all fingers except the first on background threads, if the computer has a
    /// processor for each finger. The results are bit-identical, but the run is faster.
    ///
    /// # Errors
    /// If the system cannot create the threads.
    pub fn sensing_side_by_side(self) -> Result<Self, ExperimentError> {
        let processors = thread::available_parallelism().map_or(1, usize::from);
        if self.layouts.len() > processors {
            return Ok(self);
        }
        let control_loop = self.control_loop.try_map_sensors(|sensors| {
            let mut sensors = sensors.into_iter();
            let first = sensors.next().map(Ok);
            let others =
                sensors.map(|sensor| Ok(Box::new(PrefetchingSensor::new(sensor)?) as Sensor));
            first.into_iter().chain(others).collect::<io::Result<_>>()
        });
        Ok(Self {
            control_loop: control_loop.map_err(ExperimentError::Thread)?,
            ..self
        })
    }

    /// Replaces the simulated hand by one with an independent clock. The hand is stopped after more than `max_missed`
    /// consecutive missed periods.
    #[cfg(target_os = "linux")]
    fn with_hand(self, hand: AnyHand, max_missed: u64) -> Self {
        Self {
            control_loop: self.control_loop.with_hand(hand),
            slip: self.slip.by_count(self.taken.clone()),
            max_missed,
            is_driven: true,
            ..self
        }
    }

    /// Executes one control step. Returns the readings of the instruments at its beginning.
    ///
    /// # Errors
    /// If a sensor or the hand fails.
    pub fn step(&mut self) -> Result<Instruments, ExperimentError> {
        let instruments = self.instruments();
        self.control_loop.step()?;
        Ok(instruments)
    }

    /// Returns the current readings of the rig's instruments.
    pub fn instruments(&mut self) -> Instruments {
        Instruments::read(&self.rig, self.cap, &mut self.slip)
    }

    /// Second half of a step after [`plan`](Self::plan): moves the fingers as the control laws decide.
    ///
    /// # Errors
    /// If the hand fails.
    pub fn act_with_laws(&mut self) -> Result<(), ExperimentError> {
        Ok(self.control_loop.act_with_laws()?)
    }

    /// Replaces the control law of each finger by `law(finger)`.
    pub fn set_laws(&mut self, law: impl Fn(usize) -> Box<dyn Law>) {
        self.control_loop.controller_mut().set_laws(law);
    }

    /// First half of a [`step`](Self::step), before the control laws decide: reads the hand and the sensors, and
    /// plans. For use by an agent that replaces the control laws.
    ///
    /// # Errors
    /// If a sensor or the hand fails.
    pub fn plan(&mut self) -> Result<(), ExperimentError> {
        Ok(self.control_loop.plan()?)
    }

    /// Second half of a step after [`plan`](Self::plan): moves the fingertips at `velocities` (m/s, in `W`), subject
    /// to the limits.
    ///
    /// # Errors
    /// If the hand fails.
    pub fn follow(&mut self, velocities: &[DVec3]) -> Result<(), ExperimentError> {
        Ok(self.control_loop.follow(velocities)?)
    }

    /// Returns `true` if the task is complete or was given up, or the time limit is reached. A hand that was stopped
    /// on request may be resumed, so this alone does not finish the run.
    pub fn finished(&self) -> bool {
        is_finished(&self.control_loop, self.time_limit)
    }

    /// Stops the hand on behalf of `by`. The rig continues.
    pub fn stop(&mut self, by: &str) {
        let by = by.to_string();
        let controller = self.control_loop.controller_mut();
        controller.stop(StopReason::Requested { by });
    }

    /// Resumes a stopped hand.
    pub fn resume(&mut self) {
        self.control_loop.controller_mut().resume();
    }

    /// Steps according to `schedule` until the run is [`finished`](Self::finished), `each_step` breaks or
    /// `interrupted` is set. `each_step` is called after every step with the loop, the readings of the instruments at
    /// the beginning of the step, and the timing of the step. Returns the value with which `each_step` broke, if it
    /// did.
    ///
    /// # Errors
    /// If a sensor or the hand fails.
    pub fn run<B>(
        &mut self,
        schedule: &mut impl Schedule,
        interrupted: &AtomicBool,
        each_step: impl FnMut(&mut SimulatedLoop, &Instruments, &Tick) -> ControlFlow<B>,
    ) -> Result<Option<B>, ExperimentError> {
        if self.finished() {
            return Ok(None);
        }
        let mut supervisor = InstrumentedRun {
            instruments: None,
            rig: &self.rig,
            cap: self.cap,
            slip: &mut self.slip,
            is_driven: self.is_driven,
            time_limit: self.time_limit,
            each_step,
        };
        let max_missed = self.max_missed;
        let broke =
            self.control_loop
                .run_supervised(schedule, max_missed, interrupted, &mut supervisor)?;
        Ok(broke.flatten())
    }

    /// Returns the control loop after the latest step.
    pub fn control_loop(&self) -> &SimulatedLoop {
        &self.control_loop
    }

    /// Returns the constants of the run, with ground truth of the simulated world.
    pub fn facts(&self, config: &ExperimentConfig) -> RunFacts {
        let facts = simulated_facts(config, &self.layouts, &self.rig.world());
        match self.follows_requests {
            true => facts::following(facts),
            false => facts,
        }
    }

    /// Returns the element layout of each fingertip.
    pub fn layouts(&self) -> &[ElementLayout] {
        &self.layouts
    }

    /// Returns the index of the object with a thread, if any.
    pub(crate) fn cap(&self) -> Option<usize> {
        self.cap
    }

    /// Returns the simulated rig.
    pub fn rig(&self) -> &SimRig {
        &self.rig
    }
}

fn is_finished(control_loop: &SimulatedLoop, time_limit: f64) -> bool {
    let controller = control_loop.controller();
    let over = match controller.phase() {
        Phase::Done => true,
        Phase::Stopped => !matches!(controller.stop_reason(), Some(StopReason::Requested { .. })),
        _ => false,
    };
    over || control_loop.state().stamp >= time_limit
}

/// Builds the rig of `experiment`. Also returns the index of its object with a screw thread, if any.
fn rig(
    experiment: &Experiment,
    joints: &[JointVector],
) -> Result<(SimRig, Option<usize>), ExperimentError> {
    let world = world_with(experiment, joints)?;
    let cap = experiment.config.cap();
    let cap = cap.and_then(|(name, ..)| world.model().object(name));
    Ok((SimRig::new(world), cap))
}

/// Number of simulation steps in a control period.
fn steps_per_command(config: &ExperimentConfig) -> Result<usize, ConfigError> {
    Ok((config.control.period / config.simulation()?.step).round() as usize)
}

/// Builds the simulated world of `experiment` without sensors or control, with fingers at their home positions and
/// objects at their initial poses.
///
/// # Errors
/// If a part of the experiment is invalid.
pub fn world(experiment: &Experiment) -> Result<World, ExperimentError> {
    let (_, joints) = fingers_at_home(&experiment.config)?;
    world_with(experiment, &joints)
}

/// Like [`world`], with the fingers at the joint angles `joints` (rad).
fn world_with(experiment: &Experiment, joints: &[JointVector]) -> Result<World, ExperimentError> {
    let config = &experiment.config;
    let fingers = geometries(config)?;
    let fingers: Vec<_> = fingers.into_iter().zip(layouts(config)?).collect();
    let folder = experiment.folder();
    Ok(World::new(
        config.simulation()?,
        &fingers,
        joints,
        folder,
        config.seed,
    )?)
}

/// Builds the controller of `experiment` for `fingers` with the elements of `layouts`, one each.
///
/// # Errors
/// If the control law cannot be built.
pub fn controller(
    experiment: &Experiment,
    fingers: &[FingerGeometry],
    layouts: &[ElementLayout],
) -> Result<Controller, ExperimentError> {
    let (control, task) = (control(experiment)?, &experiment.config.task);
    let mut controller = Controller::new(control, task, fingers, layouts)?;
    controller.set_couplings(experiment.config.couplings());
    Ok(controller)
}

/// Returns the controller of a hand that follows `requests`, which expire after `lifetime` (s).
///
/// # Errors
/// If a finger, a fingertip or the law is invalid.
pub(crate) fn following_controller(
    experiment: &Experiment,
    requests: &Requests,
    lifetime: f64,
) -> Result<Controller, ExperimentError> {
    let config = &experiment.config;
    let fingers = geometries(config)?;
    let task = FollowTask::new(requests.clone(), fingers.clone(), lifetime);
    let layouts = layouts(config)?;
    let control = control(experiment)?;
    let mut controller = Controller::with_task(control, Box::new(task), &fingers, &layouts)?;
    controller.set_laws(|_| planned_velocity());
    controller.set_couplings(config.couplings());
    Ok(controller)
}

/// Returns a law that commands the planned velocity unless a finger must keep a grasp.
fn planned_velocity() -> Box<dyn Law> {
    Box::new(OpenLoop::new(OpenLoopConfig::default()))
}

/// Returns the configuration of the controller. For simulated sensors without noise, the detection of frozen frames is
/// disabled, because their readings do not change while the fingers stand still.
fn control(experiment: &Experiment) -> Result<ControlConfig, ConfigError> {
    let config = &experiment.config;
    let mut control = experiment.control()?;
    let noise = config.sim.as_ref().map(|sim| match config.sensing {
        Sensing::Image => sim.optics.read_noise + sim.optics.shot_noise,
        Sensing::Direct => sim.direct_sensing.normal_noise + sim.direct_sensing.shear_noise,
    });
    if noise == Some(0.0) {
        control.monitor.frozen_frames = 0;
    }
    Ok(control)
}

/// Separator between the name of a finger and an error about it. Errors of the paper's finger begin with the name of a
/// field.
fn separator(problem: &FingerError) -> &'static str {
    match problem {
        FingerError::Chain(_) => ": ",
        _ => ".",
    }
}

/// Returns the element layout of each fingertip.
///
/// # Errors
/// If a fingertip is invalid.
pub fn layouts(config: &ExperimentConfig) -> Result<Vec<ElementLayout>, ExperimentError> {
    let fingers = 0..config.hand.finger.len();
    fingers
        .map(|finger| {
            let made = Fingertip::layout_and_projection(config.sensor.fingertip(finger));
            let made = made.map_err(|source| ExperimentError::Fingertip { finger, source });
            made.map(|(layout, _)| layout)
        })
        .collect()
}

/// Builds everything that the programs of a real rig build from `experiment`: fingers that reach their home positions,
/// fingertips, matching calibrations, and the controller.
///
/// # Errors
/// Describes the first invalid part.
pub fn check_rig(experiment: &Experiment) -> Result<Vec<ElementLayout>, ExperimentError> {
    let config = &experiment.config;
    let (fingers, _) = fingers_at_home(config)?;
    let layouts = layouts(config)?;
    controller(experiment, &fingers, &layouts)?;
    for finger in 0..layouts.len() {
        let calibration = experiment.calibration(finger)?;
        let made_for_it = calibration.verify_target(config.sensor.fingertip(finger));
        made_for_it.map_err(|source| ExperimentError::Sensor {
            finger,
            source: Box::new(source.into()),
        })?;
    }
    Ok(layouts)
}

/// Returns the fingers and the joint angles (rad) of their home positions.
///
/// # Errors
/// If a finger is invalid or cannot reach its home position.
pub fn fingers_at_home(
    config: &ExperimentConfig,
) -> Result<(Vec<FingerGeometry>, Vec<JointVector>), ExperimentError> {
    fingers_at(config, &config.task.homes())
}

/// Returns the fingers, and for each the joint angles (rad) at its position in `homes` (m, in `W`).
fn fingers_at(
    config: &ExperimentConfig,
    homes: &[[f64; 3]],
) -> Result<(Vec<FingerGeometry>, Vec<JointVector>), ExperimentError> {
    let fingers = geometries(config)?;
    if fingers.len() != homes.len() {
        let (expected, actual) = (fingers.len(), homes.len());
        return Err(ExperimentError::Homes { expected, actual });
    }
    let joints = fingers.iter().zip(homes).enumerate();
    let joints = joints.map(|(finger, (geometry, &home))| {
        let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
        inverse_kinematics(geometry, DVec3::from_array(home), middle).map_err(|source| {
            ExperimentError::Home {
                task: config.task.name(),
                finger,
                home,
                source: Box::new(source),
            }
        })
    });
    let joints = joints.collect::<Result<_, _>>()?;
    Ok((fingers, joints))
}

/// Builds the fingers of `config`, in order.
///
/// # Errors
/// If a value is out of range.
pub fn geometries(config: &ExperimentConfig) -> Result<Vec<FingerGeometry>, ExperimentError> {
    let fingers = config.hand.finger.iter().enumerate();
    let geometry = |(finger, hand)| {
        FingerGeometry::of(hand).map_err(|source| ExperimentError::Finger { finger, source })
    };
    fingers.map(geometry).collect()
}
