//! What an episode is for, in truth: its rewards, when it is over, and what is told beside.
//!
//! Rewards count in units that mean something, so that they can be read: mN·m that the cap is tightened by, mm that the object is
//! brought along its path, percent of an outline. What is gained is the difference of a potential from one step to
//! the next, wherever there is one: such rewards add up to where the episode ended, whatever way it took, and going back and
//! forth gains nothing (Ng, Harada and Russell, "Policy invariance under reward transformations", 1999). Costs are of what
//! the experiments' claims hold against a run: elements or objects pressed too hard, and work that slips take.

mod cap;
mod carry;
mod contour;

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

/// What one step brought.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Verdict {
    /// The step's reward.
    pub reward: f64,
    /// Whether the episode is over: the goal is reached, or out of reach.
    pub over: bool,
}

/// What a goal sees at the end of a step.
pub(super) struct Seen<'a> {
    /// The world.
    pub world: &'a World,
    /// What came of the episode so far.
    pub truth: Truth,
    /// Time since the step before, s.
    pub period: f64,
}

/// What an episode is for.
pub(super) trait Goal: Send {
    /// What it tells beside the reward, always in the same order, with units.
    fn names(&self) -> &'static [&'static str];

    /// An episode of `experiment` begins.
    ///
    /// # Errors
    /// When there is nothing to reach in it.
    fn begin(&mut self, experiment: &Experiment, seen: &Seen<'_>) -> Result<(), EnvironmentError>;

    /// What a step brought. Does not allocate.
    fn judge(&mut self, seen: &Seen<'_>) -> Verdict;

    /// Whether the goal is reached.
    fn reached(&self) -> bool;

    /// Writes what [`names`](Self::names) says.
    fn tell(&self, values: &mut [f64]);
}

/// The goal of `experiment`.
pub(super) fn goal(experiment: &Experiment) -> Result<Box<dyn Goal>, EnvironmentError> {
    let config = &experiment.config;
    match &config.task {
        TaskConfig::Screw(screw) if screw.until != Until::Open && config.cap().is_some() => {
            Ok(Box::new(CapGoal::default()))
        }
        TaskConfig::Carry(_) => Ok(Box::new(CarryGoal::default())),
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
    /// What is seen of `session`'s `world`, a `period` (s) after the last time.
    pub fn new(world: &'a World, session: &Session, period: f64) -> Self {
        Self {
            truth: Truth::in_world(world, session.cap()),
            world,
            period,
        }
    }

    /// How hard the hardest pressed element of all is pressed: F_z, N; 0 where none touches.
    pub fn peak_force(&self) -> f64 {
        self.compressions().fold(0.0, f64::max)
    }

    /// Sum over all elements of what they are pressed above `limit`, N.
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
