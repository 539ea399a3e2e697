//! Reinforcement learning environments: an experiment as episodes of observations, actions and rewards.
//!
//! The task of the experiment plans as usual (SEARCH, MOVE, RELEASE, RETURN), and an agent replaces the control law.
//! The agent receives the inputs of a law as the numbers of [`ObservationLayout`] and requests velocities of the
//! fingertips, which pass the same limits as every command. An agent that requests the same velocities as the
//! experiment's law therefore reproduces the run of `feeler run` with the same seed, and an agent that follows the
//! task's plan acts like a task without a law.
//!
//! Rewards and [`Environment::info`] are computed from the true state of the simulated world, which observations never
//! contain. The crate documentation lists the rewards of each task. An episode terminates when its goal is reached or
//! lost, when the task is complete, or when the hand is stopped with a reason. It is truncated at the experiment's
//! time limit.

mod action;
mod bounds;
mod episodes;
mod error;
mod goal;
mod pool;
mod slot;
mod vector;
mod vector_error;

pub use action::ActionKind;
pub use error::EnvironmentError;
pub use slot::Autoreset;
pub use vector::{Batch, VectorEnvironment};
pub use vector_error::VectorError;

use crate::config::Experiment;
use crate::experiment::{Pictures, Session};
use episodes::Episodes;
use feeler::control::{Controller, ObservationLayout, StopReason};
use feeler_sim::optics::{View, draw};
use glam::DVec3;
use goal::{Goal, Seen, Verdict, goal};

/// Names of the info values that every goal has.
const TOLD: [&str; 5] = ["time_s", "phase", "success", "peak_force_n", "slip_work_j"];

/// Configuration of an environment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EnvironmentConfig {
    /// The experiment: a built-in name or a file.
    pub experiment: String,
    /// Settings such as `control.slip_threshold=2.5`. Forces are sensed directly unless `sensing=image` is set.
    pub settings: Vec<String>,
    /// Distributions drawn for each episode, such as `friction=uniform(0.3,1.2)`. For a gripper also `object=random`:
    /// the random object of `feeler compare grip` with the seed of the episode.
    pub vary: Vec<String>,
    /// Meaning of the numbers of an action.
    pub action: ActionKind,
}

/// Result of one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Reward, in the unit of the goal.
    pub reward: f64,
    /// `true` if the episode is over.
    pub terminated: bool,
    /// `true` if the episode was cut off at the time limit.
    pub truncated: bool,
}

/// An experiment as a sequence of episodes.
pub struct Environment {
    episodes: Episodes,
    action: ActionKind,
    goal: Box<dyn Goal>,
    session: Session,
    /// `true` if the session belongs to an unfinished episode.
    under_way: bool,
    layouts: Vec<ObservationLayout>,
    velocities: Vec<DVec3>,
    observation: Vec<f32>,
    info: Vec<f64>,
}

impl Environment {
    /// Creates an environment. Call [`reset`](Self::reset) to begin the first episode.
    ///
    /// # Errors
    /// If the experiment cannot be used, or no rewards are defined for its task.
    pub fn new(config: &EnvironmentConfig) -> Result<Self, EnvironmentError> {
        let episodes = Episodes::new(&config.experiment, &config.settings, &config.vary)?;
        Self::of(episodes, config.action)
    }

    /// Creates another environment with the same configuration.
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn another(&self) -> Result<Self, EnvironmentError> {
        Self::of(self.episodes.clone(), self.action)
    }

    fn of(episodes: Episodes, action: ActionKind) -> Result<Self, EnvironmentError> {
        let goal = goal(episodes.experiment())?;
        let session = Session::rendering(episodes.experiment(), Pictures::Sensed)?;
        let layouts = observation_layouts(&session);
        let told = TOLD.len() + goal.names().len();
        Ok(Self {
            observation: vec![0.0; layouts.iter().map(ObservationLayout::len).sum()],
            velocities: vec![DVec3::ZERO; layouts.len()],
            info: vec![0.0; told],
            under_way: false,
            episodes,
            action,
            goal,
            session,
            layouts,
        })
    }

    /// Begins the episode of `seed`, or of the next seed in the sequence that starts at the last given seed. Returns
    /// its seed.
    ///
    /// # Errors
    /// If a varied value or a part of the rig is invalid. Afterwards, no episode is active.
    pub fn reset(&mut self, seed: Option<u64>) -> Result<u64, EnvironmentError> {
        self.under_way = false;
        let seed = self.episodes.next(seed)?;
        self.begin(seed)
    }

    /// Begins the episode that is reached from the episode of `seed` after `following` resets without a seed. Returns
    /// its seed.
    ///
    /// # Errors
    /// Same as [`Self::reset`].
    pub fn reset_to(&mut self, seed: u64, following: u64) -> Result<u64, EnvironmentError> {
        self.under_way = false;
        let seed = self.episodes.skip_to(seed, following)?;
        self.begin(seed)
    }

    /// Begins the episode of `seed`, for which the experiment is already set up.
    fn begin(&mut self, seed: u64) -> Result<u64, EnvironmentError> {
        let experiment = self.episodes.experiment();
        self.session = Session::rendering(experiment, Pictures::Sensed)?;
        let layouts = observation_layouts(&self.session);
        if layouts != self.layouts {
            return Err(EnvironmentError::ObservationLength {
                expected: self.observation.len(),
                actual: layouts.iter().map(ObservationLayout::len).sum(),
            });
        }
        self.session.plan()?;
        let world = self.session.rig().world();
        let seen = Seen::new(&world, &self.session, 0.0);
        self.goal.begin(experiment, &seen)?;
        tell(&self.session, &*self.goal, &seen, &mut self.info);
        drop(world);
        self.observe()?;
        self.under_way = true;
        Ok(seed)
    }

    /// Executes one control step with `action`, the numbers of each finger in turn as defined by the [`ActionKind`]. The task
    /// then plans with the new tactile data, which is the next [observation](Self::observation). Does not allocate.
    ///
    /// # Errors
    /// If no episode is active, or `action` has the wrong length or a number that is not finite; the environment is
    /// then unchanged. If the rig fails; the episode is then over.
    pub fn step(&mut self, action: &[f64]) -> Result<Step, EnvironmentError> {
        if !self.under_way {
            return Err(EnvironmentError::NoEpisode);
        }
        action::check(action, self.action_len())?;
        self.under_way = false;
        let control_loop = self.session.control_loop();
        let senses = control_loop.hand_sense().fingers();
        let fingers = control_loop.controller().fingers().iter().zip(senses);
        let mut rest = action;
        for (velocity, (finger, sense)) in self.velocities.iter_mut().zip(fingers) {
            let geometry = finger.geometry();
            let (numbers, others) = rest.split_at(self.action.width(geometry));
            rest = others;
            *velocity = self.action.velocity(numbers, geometry, &sense);
        }
        self.session.follow(&self.velocities)?;
        self.session.plan()?;
        self.observe()?;
        let verdict = self.judge();
        let over = self.controller().phase().is_final();
        let terminated = verdict.over || over;
        let limit = self.experiment().config.time_limit;
        let truncated = !terminated && self.session.control_loop().state().stamp >= limit;
        self.under_way = !(terminated || truncated);
        Ok(Step {
            reward: verdict.reward,
            terminated,
            truncated,
        })
    }

    /// Returns the latest observation: the numbers of each finger in turn, as described by [`layouts`](Self::layouts).
    pub fn observation(&self) -> &[f32] {
        &self.observation
    }

    /// Returns the layout of each finger's part of the observation.
    pub fn layouts(&self) -> &[ObservationLayout] {
        &self.layouts
    }

    /// Length of an action: three numbers per finger, or one per joint for [`ActionKind::Joints`].
    pub fn action_len(&self) -> usize {
        let fingers = self.controller().fingers().iter();
        let widths = fingers.map(|finger| self.action.width(finger.geometry()));
        widths.sum()
    }

    /// Returns the maximum magnitude of each number of an action that passes the limits unchanged (m/s or rad/s).
    pub fn action_bounds(&self) -> Vec<f64> {
        let limits = &self.experiment().config.control.limits;
        let fingers = self.controller().fingers().iter();
        let bounds = |finger| self.action.bounds(finger, limits);
        fingers
            .flat_map(|finger| bounds(finger.geometry()))
            .collect()
    }

    /// Writes the action that follows the task's plan to `action`.
    ///
    /// # Errors
    /// If `action` has the wrong length.
    pub fn guide(&self, action: &mut [f64]) -> Result<(), EnvironmentError> {
        action::check_length(action, self.action_len())?;
        let control_loop = self.session.control_loop();
        let controller = control_loop.controller();
        let senses = control_loop.hand_sense().fingers();
        let fingers = controller.fingers().iter().zip(controller.plans());
        let plans = fingers.zip(senses).flat_map(|((finger, plan), sense)| {
            (self.action).action(plan.velocity, finger.geometry(), &sense)
        });
        for (number, own) in action.iter_mut().zip(plans) {
            *number = own;
        }
        Ok(())
    }

    /// Returns ground-truth values of the latest step, in the order of [`info_names`](Self::info_names).
    pub fn info(&self) -> &[f64] {
        &self.info
    }

    /// Returns the names of the info values, with units. The phase is its number in
    /// [`Phase`](feeler::control::Phase); success is 0 or 1.
    pub fn info_names(&self) -> Vec<&'static str> {
        [&TOLD, self.goal.names()].concat()
    }

    /// Returns the reason why the hand was stopped, or `None` if it was not stopped.
    pub fn stop_reason(&self) -> Option<&StopReason> {
        self.controller().stop_reason()
    }

    /// Renders the scene in its current state as `width` times `height` RGB pixels, row by row from the top.
    ///
    /// # Errors
    /// If the length of `rgb` is not three bytes per pixel.
    pub fn render(&self, size: (usize, usize), rgb: &mut [u8]) -> Result<(), EnvironmentError> {
        let world = self.session.rig().world();
        Ok(draw(&world, &View::of(&world), size, rgb)?)
    }

    /// Returns the experiment of the latest episode.
    pub fn experiment(&self) -> &Experiment {
        self.episodes.experiment()
    }

    /// Returns the session of the latest episode.
    pub fn session(&self) -> &Session {
        &self.session
    }

    fn controller(&self) -> &Controller {
        self.session.control_loop().controller()
    }

    /// Evaluates the latest step and updates the info values.
    fn judge(&mut self) -> Verdict {
        let world = self.session.rig().world();
        let period = self.episodes.experiment().config.control.period;
        let seen = Seen::new(&world, &self.session, period);
        let verdict = self.goal.judge(&seen);
        tell(&self.session, &*self.goal, &seen, &mut self.info);
        verdict
    }

    fn observe(&mut self) -> Result<(), EnvironmentError> {
        let control_loop = self.session.control_loop();
        let controller = control_loop.controller();
        let senses = control_loop.hand_sense().fingers();
        let fingers = controller.fingers().iter().zip(controller.plans());
        let mut rest = &mut self.observation[..];
        for ((layout, sense), (finger, plan)) in self.layouts.iter().zip(senses).zip(fingers) {
            let (own, others) = rest.split_at_mut(layout.len());
            layout.write(plan, &sense, finger.velocity, own)?;
            rest = others;
        }
        Ok(())
    }
}

/// Writes the info values of the latest step of `session` to `info`.
fn tell(session: &Session, goal: &dyn Goal, seen: &Seen<'_>, info: &mut [f64]) {
    let control_loop = session.control_loop();
    let told = [
        control_loop.state().stamp,
        f64::from(u8::from(control_loop.controller().phase())),
        f64::from(u8::from(goal.reached())),
        seen.peak_force(),
        seen.truth.slip_work,
    ];
    let (common, own) = info.split_at_mut(told.len());
    common.copy_from_slice(&told);
    goal.tell(own);
}

/// Returns the layout of each finger's observation in `session`.
fn observation_layouts(session: &Session) -> Vec<ObservationLayout> {
    let fingers = session.control_loop().controller().fingers().iter();
    let fingers = fingers.zip(session.layouts());
    let layouts = fingers.map(|(control, layout)| ObservationLayout {
        elements: layout.elements.len(),
        joints: control.geometry().joint_count(),
    });
    layouts.collect()
}
