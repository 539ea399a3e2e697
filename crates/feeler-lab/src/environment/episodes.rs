//! What each episode is made of: the experiment, what varies in it, and the seeds.

use super::EnvironmentError;
use crate::config::Experiment;
use crate::sweep::parameter::{Parameter, check_conflicts, settings};
use crate::sweep::trial::generator;
use rand::RngExt;
use rand_pcg::Pcg64;

/// The stream that seeds come from which nobody gives.
const SEEDS: &str = "next episode";

/// The episodes of one environment.
#[derive(Debug, Clone)]
pub(super) struct Episodes {
    experiment: Experiment,
    parameters: Vec<Parameter>,
    seeds: Pcg64,
}

impl Episodes {
    /// Episodes of the experiment called `name` with `settings`, in which the `vary` expressions draw anew each time.
    /// Forces are sensed directly where `settings` do not say otherwise.
    pub fn new(name: &str, settings: &[String], vary: &[String]) -> Result<Self, EnvironmentError> {
        let settings = [&["sensing=direct".to_string()], settings].concat();
        let experiment = Experiment::load(name, &settings)?;
        let parameters = vary.iter().map(|said| Parameter::parse(said, &experiment));
        let parameters = parameters.collect::<Result<Vec<_>, _>>()?;
        check_conflicts(&parameters)?;
        Ok(Self {
            seeds: generator(experiment.config.seed, 0, SEEDS),
            experiment,
            parameters,
        })
    }

    /// The experiment of the newest episode.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// Sets the experiment to that of the episode `following` episodes after that of `seed`.
    pub fn skip_to(&mut self, seed: u64, following: u64) -> Result<u64, EnvironmentError> {
        if following == 0 {
            return self.next(Some(seed));
        }
        self.seeds = generator(seed, 0, SEEDS);
        for _ in 1..following {
            self.seeds.random::<u64>();
        }
        self.next(None)
    }

    /// Makes the experiment that of the episode of `seed`, or of the next seed that follows from the last one given.
    ///
    /// What varies draws what trial 0 of a sweep of that seed would; so do seeds that nobody gives.
    pub fn next(&mut self, seed: Option<u64>) -> Result<u64, EnvironmentError> {
        if let Some(seed) = seed {
            self.seeds = generator(seed, 0, SEEDS);
        }
        // A seed of an experiment file is a TOML integer, which has a sign.
        let seed = seed.unwrap_or_else(|| self.seeds.random::<u64>() >> 1);
        if !self.parameters.is_empty() {
            let draw = |p: &Parameter| {
                let mut stream = generator(seed, 0, &p.name);
                p.distribution.draw(&mut stream, p.whole)
            };
            let values: Vec<_> = self.parameters.iter().map(draw).collect();
            let settings = settings(self.parameters.iter().zip(&values))?;
            self.experiment = self.experiment.with_settings(&settings)?;
        }
        self.experiment.config.seed = seed;
        Ok(seed)
    }
}
