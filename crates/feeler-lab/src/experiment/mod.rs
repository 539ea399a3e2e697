//! One run in one process: the simulated rig, its sensors, the control loop and the recorder, wired up.

#[cfg(target_os = "linux")]
pub mod driven;
#[cfg(target_os = "linux")]
pub mod driven_rig;
mod facts;
mod held_touch;
mod in_memory;
mod instruments;
pub mod linked;
pub mod played_rig;
pub mod recorded_run;
pub mod replay;
mod reported_recorder;
pub mod run_folder;
mod sensors;
pub mod slip_bench;
mod solids;
pub mod specimen;
mod supervised;
mod threaded_touch;
pub mod truth;
pub mod warnings;

use crate::config::{ConfigError, Experiment, ExperimentConfig, Sensing};
pub use facts::run_facts;
pub(crate) use facts::{cap_facts, true_section};
pub use instruments::Instruments;

use facts::simulated_facts;
use feeler::control::control_loop::{ControlError, ControlLoop};
use feeler::control::controller::{ControlConfig, Controller};
use feeler::control::law::{Law, LawError};
use feeler::control::phase::Phase;
use feeler::control::stop_reason::StopReason;
use feeler::control::task::Task;
use feeler::control::touch::TouchSource;
use feeler::hand::Hand;
use feeler::hand::finger::{FingerError, FingerGeometry};
use feeler::hand::inverse_kinematics::{KinematicsError, inverse_kinematics};
use feeler::pace::{Schedule, Tick};
use feeler::sensor::fingertip::{Fingertip, FingertipError};
use feeler::sensor::layout::ElementLayout;
use feeler::sensor::sensing::SensingError;
use feeler_record::{RecordError, RunFacts};
use feeler_sim::error::SimError;
use feeler_sim::optics_config::OpticsError;
use feeler_sim::rig::{SimHand, SimRig};
use feeler_sim::world::World;
use glam::DVec3;
use held_touch::FramesTaken;
use specimen::{SpecimenError, check_specimen};
use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::thread;
use supervised::InstrumentedRun;
use threaded_touch::ThreadedTouch;
use truth::SlipMeter;

/// Why a run could not be set up or go on.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The experiment file or its calibration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A finger makes no sense.
    #[error("hand.finger[{finger}].{source}")]
    Finger {
        /// The finger.
        finger: usize,
        /// What is wrong with it.
        source: FingerError,
    },
    /// A finger cannot reach its home.
    #[error("task.{task}.finger[{finger}].home = {home:?} cannot be reached: {source}")]
    Home {
        /// The task.
        task: &'static str,
        /// The finger.
        finger: usize,
        /// Where it should be, m, in W.
        home: [f64; 3],
        /// Why it cannot.
        source: Box<KinematicsError>,
    },
    /// Not every finger has a home, or there are more homes than fingers.
    #[error("{expected} homes expected, one for each finger, not {actual}")]
    Homes {
        /// Number of fingers.
        expected: usize,
        /// Number of homes.
        actual: usize,
    },
    /// A fingertip makes no sense.
    #[error("sensor.fingertip: finger {finger}: {source}")]
    Fingertip {
        /// The finger that carries it.
        finger: usize,
        /// What is wrong with it.
        source: FingertipError,
    },
    /// The optics make no sense.
    #[error("sim.optics: {0}")]
    Optics(#[from] OpticsError),
    /// The simulated world cannot be built.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// There is nothing to touch where the task expects it.
    #[error(transparent)]
    Specimen(#[from] SpecimenError),
    /// A sensor cannot be built.
    #[error("sensor: finger {finger}: {source}")]
    Sensor {
        /// The finger that carries it.
        finger: usize,
        /// What is wrong with it.
        source: Box<SensingError>,
    },
    /// The system gives no thread to a sensor.
    #[error("a sensor's thread: {0}")]
    Thread(io::Error),
    /// The control law cannot be built.
    #[error("control.law: {0}")]
    Law(#[from] LawError),
    /// The loop could not go round.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// A message could not be recorded.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// A fingertip's sensor, of whichever kind.
pub type Sensor = Box<dyn TouchSource + Send>;

/// What moves the fingers: the simulated hand, or drives with the simulated world behind them.
pub type AnyHand = Box<dyn Hand + Send>;

/// The control loop of a simulated rig.
pub type SimulatedLoop = ControlLoop<Sensor, AnyHand>;

/// What simulated cameras draw of their pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pictures {
    /// All of it: what is recorded or shown.
    Whole,
    /// What is sensed, about half of it: sensors tell the same, to the bit.
    Sensed,
}

/// A run under way.
pub struct Session {
    rig: SimRig,
    control_loop: SimulatedLoop,
    layouts: Vec<ElementLayout>,
    /// The object on a thread.
    cap: Option<usize>,
    slip: SlipMeter,
    time_limit: f64,
    /// Periods that may be missed in a row.
    most_missed: u64,
    /// Pictures of finger 0 that were taken, where there is not one in every control period.
    taken: FramesTaken,
    /// The world goes on by itself, whether steps are made or not.
    is_driven: bool,
}

impl Session {
    /// Sets up a run of `experiment`: fingers at home, cap open.
    ///
    /// # Errors
    /// When a part of the experiment makes no sense.
    pub fn new(experiment: &Experiment) -> Result<Self, ExperimentError> {
        Self::drawing(experiment, Pictures::Whole)
    }

    /// The same with cameras that draw as much of their `pictures`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn drawing(experiment: &Experiment, pictures: Pictures) -> Result<Self, ExperimentError> {
        let task = &experiment.config.task;
        Self::with_task_drawing(experiment, task.task(), &task.homes(), pictures)
    }

    /// The same with `task` in place of the experiment's. The fingers start from `homes`, m in `W`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_task(
        experiment: &Experiment,
        task: Box<dyn Task>,
        homes: &[[f64; 3]],
    ) -> Result<Self, ExperimentError> {
        Self::with_task_drawing(experiment, task, homes, Pictures::Whole)
    }

    /// [`Self::with_task`] with cameras that draw as much of their `pictures`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_task_drawing(
        experiment: &Experiment,
        task: Box<dyn Task>,
        homes: &[[f64; 3]],
        pictures: Pictures,
    ) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        let layouts = layouts(config)?;
        let (fingers, joints) = fingers_at(config, homes)?;
        let controller = Controller::with_task(control(experiment)?, task, &fingers, &layouts)?;
        let (rig, cap) = rig(experiment, &joints)?;
        check_specimen(config, &fingers, &rig.world())?;
        let taken = FramesTaken::default();
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
            // Simulated time waits for its steps: none that is missed does harm.
            most_missed: u64::MAX,
            taken,
            is_driven: false,
        })
    }

    /// The same with the pictures of all fingers but the first taken and sensed on threads of their own, where the computer has a processor
    /// for each. The run is the same, to the bit, and sooner over.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn sensing_side_by_side(self) -> Result<Self, ExperimentError> {
        let processors = thread::available_parallelism().map_or(1, usize::from);
        if self.layouts.len() > processors {
            return Ok(self);
        }
        let control_loop = self.control_loop.try_map_sensors(|sensors| {
            let mut sensors = sensors.into_iter();
            let first = sensors.next().map(Ok);
            let others = sensors.map(|sensor| Ok(Box::new(ThreadedTouch::new(sensor)?) as Sensor));
            first.into_iter().chain(others).collect::<io::Result<_>>()
        });
        Ok(Self {
            control_loop: control_loop.map_err(ExperimentError::Thread)?,
            ..self
        })
    }

    /// The same with a hand that keeps its own time in place of the simulated one; more than `most_missed` periods that are missed in
    /// a row stop it.
    #[cfg(target_os = "linux")]
    fn with_hand(self, hand: AnyHand, most_missed: u64) -> Self {
        Self {
            control_loop: self.control_loop.with_hand(hand),
            slip: self.slip.by_count(self.taken.clone()),
            most_missed,
            is_driven: true,
            ..self
        }
    }

    /// Goes round the control loop once; what the instruments said when it began.
    ///
    /// # Errors
    /// When a sensor or the hand fails.
    pub fn step(&mut self) -> Result<Instruments, ExperimentError> {
        let instruments = self.instruments();
        self.control_loop.step()?;
        Ok(instruments)
    }

    /// What the rig's own instruments read now.
    pub fn instruments(&mut self) -> Instruments {
        Instruments::read(&self.rig, self.cap, &mut self.slip)
    }

    /// The other half after [`plan`](Self::plan), as the control laws say.
    ///
    /// # Errors
    /// When the hand fails.
    pub fn obey(&mut self) -> Result<(), ExperimentError> {
        Ok(self.control_loop.obey()?)
    }

    /// Gives each finger, by its number, the control law that `law` makes for it, in place of the experiment's.
    pub fn set_laws(&mut self, law: impl Fn(usize) -> Box<dyn Law>) {
        self.control_loop.controller_mut().set_laws(law);
    }

    /// The first half of a [`step`](Self::step), up to where the control laws would decide: reads the hand and the sensors,
    /// and plans. For an agent in their place.
    ///
    /// # Errors
    /// When a sensor or the hand fails.
    pub fn plan(&mut self) -> Result<(), ExperimentError> {
        Ok(self.control_loop.plan()?)
    }

    /// The other half after [`plan`](Self::plan): moves the fingertips at `velocities`, m/s in `W`, as far as the limits admit.
    ///
    /// # Errors
    /// When the hand fails.
    pub fn follow(&mut self, velocities: &[DVec3]) -> Result<(), ExperimentError> {
        Ok(self.control_loop.follow(velocities)?)
    }

    /// Whether the task is done or was given up, or the time is over. A hand that was told to stop may
    /// be told to go on, so that ends nothing.
    pub fn finished(&self) -> bool {
        is_finished(&self.control_loop, self.time_limit)
    }

    /// Stops the hand from outside the control law, as `by` says; the rig goes on.
    pub fn stop(&mut self, by: &str) {
        let by = by.to_string();
        let controller = self.control_loop.controller_mut();
        controller.stop(StopReason::Told { by });
    }

    /// Lets a hand that was stopped go on.
    pub fn resume(&mut self) {
        self.control_loop.controller_mut().resume();
    }

    /// Makes steps whenever `schedule` says so until the run is [`finished`](Self::finished), `each_step` breaks or
    /// `interrupted` is raised. `each_step` sees the loop after every step, what the instruments read when it
    /// began, and how punctual it was. Returns what `each_step` broke with, if it did.
    ///
    /// # Errors
    /// When a sensor or the hand fails.
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
        let most_missed = self.most_missed;
        let broke = self.control_loop.run_supervised(
            schedule,
            most_missed,
            interrupted,
            &mut supervisor,
        )?;
        Ok(broke.flatten())
    }

    /// The control loop, as of the newest step.
    pub fn control_loop(&self) -> &SimulatedLoop {
        &self.control_loop
    }

    /// The constants of the run, with what only the simulated world knows.
    pub fn facts(&self, config: &ExperimentConfig) -> RunFacts {
        simulated_facts(config, &self.layouts, &self.rig.world())
    }

    /// The elements of each finger's fingertip.
    pub fn layouts(&self) -> &[ElementLayout] {
        &self.layouts
    }

    /// The object on a thread, if there is one.
    pub(crate) fn cap(&self) -> Option<usize> {
        self.cap
    }

    /// The simulated rig.
    pub fn rig(&self) -> &SimRig {
        &self.rig
    }
}

fn is_finished(control_loop: &SimulatedLoop, time_limit: f64) -> bool {
    let controller = control_loop.controller();
    let over = match controller.phase() {
        Phase::Done => true,
        Phase::Stopped => !matches!(controller.stop_reason(), Some(StopReason::Told { .. })),
        _ => false,
    };
    over || control_loop.state().stamp >= time_limit
}

/// The rig of `experiment`, and its object on a thread.
fn rig(
    experiment: &Experiment,
    joints: &[DVec3],
) -> Result<(SimRig, Option<usize>), ExperimentError> {
    let world = world_with(experiment, joints)?;
    let cap = experiment.config.cap();
    let cap = cap.and_then(|(name, ..)| world.model().object(name));
    Ok((SimRig::new(world), cap))
}

/// Steps of the world in a control period.
fn steps_per_command(config: &ExperimentConfig) -> Result<usize, ConfigError> {
    Ok((config.control.period / config.simulation()?.step).round() as usize)
}

/// The simulated world of `experiment`, without sensors or control: fingers at home, objects where they
/// start.
///
/// # Errors
/// When a part of it makes no sense.
pub fn world(experiment: &Experiment) -> Result<World, ExperimentError> {
    let (_, joints) = fingers_at_home(&experiment.config)?;
    world_with(experiment, &joints)
}

/// The same with the fingers at these joint angles, rad.
fn world_with(experiment: &Experiment, joints: &[DVec3]) -> Result<World, ExperimentError> {
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

/// The controller of `experiment` for `fingers` with the elements of `layouts`, one each.
///
/// # Errors
/// When its control law cannot be built.
pub fn controller(
    experiment: &Experiment,
    fingers: &[FingerGeometry],
    layouts: &[ElementLayout],
) -> Result<Controller, ExperimentError> {
    let (control, task) = (control(experiment)?, &experiment.config.task);
    Ok(Controller::new(control, task, fingers, layouts)?)
}

/// What the controller is tuned by: as `experiment` says, but that simulated sensors without noise may say the same for as
/// long as the fingers stand still.
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

/// The elements of each finger's fingertip.
///
/// # Errors
/// When a fingertip makes no sense.
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

/// Builds all that a real rig's programs build of `experiment`: fingers that reach their homes, fingertips, calibrations that were
/// made for them, and the controller.
///
/// # Errors
/// The first part that makes no sense.
pub fn check_rig(experiment: &Experiment) -> Result<Vec<ElementLayout>, ExperimentError> {
    let config = &experiment.config;
    let (fingers, _) = fingers_at_home(config)?;
    let layouts = layouts(config)?;
    controller(experiment, &fingers, &layouts)?;
    for finger in 0..layouts.len() {
        let calibration = experiment.calibration(finger)?;
        let made_for_it = calibration.check_made_for(config.sensor.fingertip(finger));
        made_for_it.map_err(|source| ExperimentError::Sensor {
            finger,
            source: Box::new(source.into()),
        })?;
    }
    Ok(layouts)
}

/// The fingers and the joint angles, rad, that bring them home.
///
/// # Errors
/// When a finger makes no sense or cannot reach its home.
pub fn fingers_at_home(
    config: &ExperimentConfig,
) -> Result<(Vec<FingerGeometry>, Vec<DVec3>), ExperimentError> {
    fingers_at(config, &config.task.homes())
}

/// The fingers and the joint angles, rad, that bring them to `homes`, m in `W`, one each.
fn fingers_at(
    config: &ExperimentConfig,
    homes: &[[f64; 3]],
) -> Result<(Vec<FingerGeometry>, Vec<DVec3>), ExperimentError> {
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

/// The fingers of `config`, in order.
///
/// # Errors
/// When a value of one is out of range.
fn geometries(config: &ExperimentConfig) -> Result<Vec<FingerGeometry>, ExperimentError> {
    let fingers = config.hand.finger.iter().enumerate();
    let geometry = |(finger, hand)| {
        FingerGeometry::new(hand).map_err(|source| ExperimentError::Finger { finger, source })
    };
    fingers.map(geometry).collect()
}
