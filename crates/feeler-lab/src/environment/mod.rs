//! Environments for learning: an experiment as episodes of observations, actions and rewards.
//!
//! The task of the experiment runs inside and plans (SEARCH, MOVE, RELEASE, RETURN); an agent stands where the control law
//! does. It gets what a law gets, as the numbers of [`ObservationLayout`], and says how the fingertips are to move. That passes the
//! limits that every command passes. So an agent that says what the experiment's law would say makes the very run that `feeler run`
//! makes of the same seed, and one that says what the task plans does what a task without a law does.
//!
//! Rewards and what is told beside ([`Environment::info`]) are of the true state of the simulated world, which observations never
//! contain; the crate's front page says what each task is rewarded for. An episode is over when its goal is reached or lost, when the task is through, or when the
//! hand is stopped with a reason; it is cut off at the experiment's time limit.

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
pub use vector::{Autoreset, Batch, VectorEnvironment};
pub use vector_error::VectorError;

use crate::config::Experiment;
use crate::experiment::{Pictures, Session};
use episodes::Episodes;
use feeler::control::controller::Controller;
use feeler::control::observation::ObservationLayout;
use feeler::control::phase::Phase;
use feeler::control::stop_reason::StopReason;
use feeler_sim::picture::{View, draw};
use glam::DVec3;
use goal::{Goal, Seen, Verdict, goal};

/// What is told of every step, whatever the goal.
const TOLD: [&str; 5] = ["time_s", "phase", "success", "peak_force_n", "slip_work_j"];

/// What an environment is made of.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EnvironmentConfig {
    /// The experiment: a built-in one or a file.
    pub experiment: String,
    /// What is set in it, as in `control.slip_threshold=2.5`. Forces are sensed directly unless `sensing=image` is set.
    pub settings: Vec<String>,
    /// What each episode draws anew, as in `friction=uniform(0.3,1.2)`.
    pub vary: Vec<String>,
    /// What the numbers of an action mean.
    pub action: ActionKind,
}

/// What one step brought.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Its reward, in the unit of the goal.
    pub reward: f64,
    /// Whether the episode is over.
    pub terminated: bool,
    /// Whether it was cut off at the time limit.
    pub truncated: bool,
}

/// An experiment as episodes, one at a time.
pub struct Environment {
    episodes: Episodes,
    action: ActionKind,
    goal: Box<dyn Goal>,
    session: Session,
    /// Whether the session is that of an episode that goes on.
    under_way: bool,
    layouts: Vec<ObservationLayout>,
    velocities: Vec<DVec3>,
    observation: Vec<f32>,
    info: Vec<f64>,
}

impl Environment {
    /// The environment of `config`, before the first episode.
    ///
    /// # Errors
    /// When the experiment cannot be used, or there are no rewards for its task.
    pub fn new(config: &EnvironmentConfig) -> Result<Self, EnvironmentError> {
        let episodes = Episodes::new(&config.experiment, &config.settings, &config.vary)?;
        Self::of(episodes, config.action)
    }

    /// Another one of the same kind, before its first episode.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn another(&self) -> Result<Self, EnvironmentError> {
        Self::of(self.episodes.clone(), self.action)
    }

    fn of(episodes: Episodes, action: ActionKind) -> Result<Self, EnvironmentError> {
        let goal = goal(episodes.experiment())?;
        let session = Session::drawing(episodes.experiment(), Pictures::Sensed)?;
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

    /// Begins the episode of `seed`; without one, that of a seed that follows from the last one given. Its number.
    ///
    /// # Errors
    /// When what varies in it, or a part of the rig, makes no sense. There is then no episode under way.
    pub fn reset(&mut self, seed: Option<u64>) -> Result<u64, EnvironmentError> {
        self.under_way = false;
        let seed = self.episodes.next(seed)?;
        self.begin(seed)
    }

    /// Begins the episode `following` episodes after that of `seed` (0: that one), as resets without a seed reach it. Returns the
    /// episode's own seed.
    ///
    /// # Errors
    /// As [`Self::reset`].
    pub fn reset_to(&mut self, seed: u64, following: u64) -> Result<u64, EnvironmentError> {
        self.under_way = false;
        let seed = self.episodes.skip_to(seed, following)?;
        self.begin(seed)
    }

    /// Begins the episode of `seed`, for which the experiment is already set.
    fn begin(&mut self, seed: u64) -> Result<u64, EnvironmentError> {
        let experiment = self.episodes.experiment();
        self.session = Session::drawing(experiment, Pictures::Sensed)?;
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

    /// Makes a control step in which the fingers do what `action` says, three numbers each. The task then plans on what they
    /// feel, which is the next [observation](Self::observation). Does not allocate.
    ///
    /// # Errors
    /// When there is no episode under way, `action` has another length or a number that is not finite; then nothing has happened. When
    /// the rig fails; the episode is over then.
    pub fn step(&mut self, action: &[f64]) -> Result<Step, EnvironmentError> {
        if !self.under_way {
            return Err(EnvironmentError::NoEpisode);
        }
        action::check(action, self.action_len())?;
        self.under_way = false;
        let control_loop = self.session.control_loop();
        let senses = control_loop.hand_sense().fingers();
        let fingers = control_loop.controller().fingers().iter().zip(senses);
        let asked = self.velocities.iter_mut().zip(action.chunks_exact(3));
        for ((velocity, numbers), (finger, sense)) in asked.zip(fingers) {
            let numbers = DVec3::from_slice(numbers);
            *velocity = self.action.velocity(numbers, finger.geometry(), &sense);
        }
        self.session.follow(&self.velocities)?;
        self.session.plan()?;
        self.observe()?;
        let verdict = self.judge();
        let over = matches!(self.controller().phase(), Phase::Done | Phase::Stopped);
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

    /// What the hand feels: each finger's observation after the other's, as [`layouts`](Self::layouts) say.
    pub fn observation(&self) -> &[f32] {
        &self.observation
    }

    /// Where in each finger's observation what stands.
    pub fn layouts(&self) -> &[ObservationLayout] {
        &self.layouts
    }

    /// Numbers of an action: three for each finger.
    pub fn action_len(&self) -> usize {
        3 * self.layouts.len()
    }

    /// How large each number of an action can be before a limit changes it, of either sign: m/s or rad/s.
    pub fn action_bounds(&self) -> Vec<f64> {
        let limits = &self.experiment().config.control.limits;
        let fingers = self.controller().fingers().iter();
        let bounds = |finger| self.action.bounds(finger, limits).to_array();
        fingers
            .flat_map(|finger| bounds(finger.geometry()))
            .collect()
    }

    /// Writes the action that follows the task's plan.
    ///
    /// # Errors
    /// When `action` has another length than an action.
    pub fn guide(&self, action: &mut [f64]) -> Result<(), EnvironmentError> {
        action::check_length(action, self.action_len())?;
        let control_loop = self.session.control_loop();
        let controller = control_loop.controller();
        let senses = control_loop.hand_sense().fingers();
        let fingers = controller.fingers().iter().zip(controller.plans());
        for ((numbers, sense), (finger, plan)) in
            action.chunks_exact_mut(3).zip(senses).zip(fingers)
        {
            let own = self.action.action(plan.velocity, finger.geometry(), &sense);
            numbers.copy_from_slice(&own.to_array());
        }
        Ok(())
    }

    /// What is told of the newest step, in truth, in the order of [`info_names`](Self::info_names).
    pub fn info(&self) -> &[f64] {
        &self.info
    }

    /// What is told of each step, with units; the phase as its number in [`Phase`], success as 0 or 1.
    pub fn info_names(&self) -> Vec<&'static str> {
        [&TOLD, self.goal.names()].concat()
    }

    /// Why the hand was stopped, if it was.
    pub fn stop_reason(&self) -> Option<&StopReason> {
        self.controller().stop_reason()
    }

    /// Draws the scene as it is now: `width` times `height` pixels, row by row from the top, red, green and blue of each.
    ///
    /// # Errors
    /// When `rgb` has another length than three bytes for each pixel.
    pub fn render(&self, size: (usize, usize), rgb: &mut [u8]) -> Result<(), EnvironmentError> {
        let world = self.session.rig().world();
        Ok(draw(&world, &View::of(&world), size, rgb)?)
    }

    /// The experiment of the newest episode.
    pub fn experiment(&self) -> &Experiment {
        self.episodes.experiment()
    }

    /// The run behind the newest episode.
    pub fn session(&self) -> &Session {
        &self.session
    }

    fn controller(&self) -> &Controller {
        self.session.control_loop().controller()
    }

    /// Judges the newest step, and tells of it.
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

/// Writes to `info` what is told of the newest step of `session`.
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

/// Where in the observation of each finger of `session` what stands.
fn observation_layouts(session: &Session) -> Vec<ObservationLayout> {
    let elements = session.layouts().iter().map(|layout| layout.elements.len());
    elements
        .map(|elements| ObservationLayout { elements })
        .collect()
}
