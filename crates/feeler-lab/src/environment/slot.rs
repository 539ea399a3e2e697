//! One environment of a vector environment, with its requested operation and results.

use super::{Environment, EnvironmentError, Step};

/// Time at which a finished environment begins its next episode, with the names of Gymnasium.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Autoreset {
    /// In the following step, which ignores its action and returns reward 0.
    #[default]
    NextStep,
    /// In the step that ends the episode. The step returns the observation of the new episode;
    /// `VectorEnvironment::last` returns the final one of the old episode.
    SameStep,
    /// Only on `VectorEnvironment::reset`; an earlier step is an error.
    Disabled,
}

/// Operation of an environment in a round.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Order {
    /// No operation.
    #[default]
    Rest,
    /// Makes a step.
    Step,
    /// Begins an episode, with the given seed or the next one.
    Reset(Option<u64>),
}

/// An environment with its requested operation and results.
pub(super) struct Slot {
    pub environment: Environment,
    pub order: Order,
    pub action: Vec<f64>,
    pub step: Step,
    /// Final observation and info of an episode, if the latest step already began another one.
    pub last: Last,
    pub error: Option<EnvironmentError>,
    autoreset: Autoreset,
    /// `true` if the next step begins an episode.
    begins: bool,
}

/// Final state of an episode that was followed by another one in the same step.
pub(super) struct Last {
    /// `true` if the latest step ended an episode.
    pub is_new: bool,
    pub observation: Vec<f32>,
    pub info: Vec<f64>,
}

impl Slot {
    /// Creates a slot for `environment`, before its first episode.
    pub fn new(environment: Environment, autoreset: Autoreset) -> Self {
        Self {
            order: Order::default(),
            action: vec![0.0; environment.action_len()],
            step: Step::default(),
            last: Last {
                is_new: false,
                observation: environment.observation().to_vec(),
                info: environment.info().to_vec(),
            },
            error: None,
            autoreset,
            begins: false,
            environment,
        }
    }

    /// Executes the requested operation.
    pub fn work(&mut self) {
        self.last.is_new = false;
        self.error = match self.order {
            Order::Rest => Ok(()),
            Order::Reset(seed) => self.begin(seed),
            Order::Step if self.begins => self.begin(None),
            Order::Step => self.go_on(),
        }
        .err();
    }

    fn begin(&mut self, seed: Option<u64>) -> Result<(), EnvironmentError> {
        self.begins = false;
        self.step = Step::default();
        self.environment.reset(seed).map(|_| ())
    }

    fn go_on(&mut self) -> Result<(), EnvironmentError> {
        self.step = self.environment.step(&self.action)?;
        let ended = self.step.terminated || self.step.truncated;
        match self.autoreset {
            Autoreset::NextStep => self.begins = ended,
            Autoreset::SameStep if ended => {
                self.last.is_new = true;
                let Last {
                    observation, info, ..
                } = &mut self.last;
                observation.copy_from_slice(self.environment.observation());
                info.copy_from_slice(self.environment.info());
                self.environment.reset(None)?;
            }
            Autoreset::SameStep | Autoreset::Disabled => {}
        }
        Ok(())
    }
}
