//! Goals of episodes, computed from ground truth: rewards, termination and additional info values.
//!
//! Rewards have physical units so that they can be interpreted: mN·m of tightening torque, mm along a path, percent of
//! an outline. Where possible, the reward is the difference of a potential between two steps. Such rewards sum up to a
//! value that depends only on the final state, and moving back and forth gains nothing (Ng, Harada and Russell,
//! "Policy invariance under reward transformations", 1999). Costs correspond to the experiments' claims: overloaded
//! elements or objects, and slip work.

mod cap;
mod carry;
mod contour;
mod grip;

use super::EnvironmentError;
use crate::config::Experiment;
use crate::experiment::Session;
use crate::experiment::truth::Truth;
use cap::CapGoal;
use carry::CarryGoal;
use contour::ContourGoal;
use feeler::control::task::TaskConfig;
use feeler::control::task::cap_config::Until;
use feeler_sim::world::World;
use grip::GripGoal;

/// Evaluation of one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Verdict {
    /// Reward of the step.
    pub reward: f64,
    /// `true` if the episode is over because the goal is reached or out of reach.
    pub over: bool,
}

/// Input of a goal at the end of a step.
pub(super) struct Seen<'a> {
    /// The simulated world.
    pub world: &'a World,
    /// Ground truth of the episode up to this step.
    pub truth: Truth,
    /// Time since the previous step (s).
    pub period: f64,
}

/// Goal of an episode.
pub(super) trait Goal: Send {
    /// Names of the goal's info values with units, always in the same order.
    fn names(&self) -> &'static [&'static str];

    /// Prepares for an episode of `experiment`.
    ///
    /// # Errors
    /// If the experiment has no such goal.
    fn begin(&mut self, experiment: &Experiment, seen: &Seen<'_>) -> Result<(), EnvironmentError>;

    /// Evaluates a step. Does not allocate.
    fn judge(&mut self, seen: &Seen<'_>) -> Verdict;

    /// Returns `true` if the goal is reached.
    fn reached(&self) -> bool;

    /// Writes the goal's info values in the order of [`names`](Self::names).
    fn tell(&self, values: &mut [f64]);
}

/// Returns the goal of `experiment`.
pub(super) fn goal(experiment: &Experiment) -> Result<Box<dyn Goal>, EnvironmentError> {
    let config = &experiment.config;
    match &config.task {
        TaskConfig::Screw(screw) if screw.until != Until::Open && config.cap().is_some() => {
            Ok(Box::new(CapGoal::default()))
        }
        TaskConfig::Carry(_) => Ok(Box::new(CarryGoal::default())),
        TaskConfig::Grip(_) => Ok(Box::new(GripGoal::default())),
        TaskConfig::Contour(_) => Ok(Box::new(ContourGoal::default())),
        _ => Err(no_goal(experiment)),
    }
}

fn no_goal(experiment: &Experiment) -> EnvironmentError {
    EnvironmentError::NoGoal {
        name: experiment.config.name.clone(),
        task: experiment.config.task.name(),
    }
}

impl<'a> Seen<'a> {
    /// Creates the input for the `world` of `session`, `period` seconds after the previous one.
    pub fn new(world: &'a World, session: &Session, period: f64) -> Self {
        Self {
            truth: Truth::in_world(world, session.cap()),
            world,
            period,
        }
    }

    /// Maximum compression F_z of all elements (N); 0 if none touches.
    pub fn peak_force(&self) -> f64 {
        self.compressions().fold(0.0, f64::max)
    }

    /// Sum over all elements of the compression above `limit` (N).
    fn excess(&self, limit: f64) -> f64 {
        self.compressions()
            .map(|force| (force - limit).max(0.0))
            .sum()
    }

    fn compressions(&self) -> impl Iterator<Item = f64> {
        let fingers = 0..self.world.state().fingers.len();
        fingers.flat_map(|finger| self.world.compressions(finger))
    }
}
