//! The sequence of episodes: the experiment, its varied values, and the seeds.

use super::EnvironmentError;
use crate::config::Experiment;
use crate::grips::place_random_object;
use crate::sweep::plan::parameter::{Parameter, check_conflicts, settings};
use crate::sweep::trial::generator;
use feeler::control::task::TaskConfig;
use rand::RngExt;
use rand_pcg::Pcg64;

/// Name of the random stream that generates seeds when the caller gives none.
const SEEDS: &str = "next episode";

/// Variation that draws a random object for a gripper.
const RANDOM_OBJECT: &str = "object=random";

/// The sequence of episodes of one environment.
#[derive(Debug, Clone)]
pub(super) struct Episodes {
    experiment: Experiment,
    /// The experiment without an object, if each episode adds a random one.
    empty: Option<Experiment>,
    parameters: Vec<Parameter>,
    seeds: Pcg64,
}

impl Episodes {
    /// Creates episodes of the experiment `name` with `settings`. The distributions `vary` are drawn for each episode.
    /// Forces are sensed directly unless `settings` selects otherwise.
    pub fn new(name: &str, settings: &[String], vary: &[String]) -> Result<Self, EnvironmentError> {
        let settings = [&["sensing=direct".to_string()], settings].concat();
        let experiment = Experiment::load(name, &settings)?;
        let (random, vary): (Vec<_>, Vec<_>) = vary.iter().partition(|said| *said == RANDOM_OBJECT);
        let draws_object = !random.is_empty();
        if draws_object && !matches!(experiment.config.task, TaskConfig::Grip(_)) {
            return Err(EnvironmentError::NoRandomObject {
                name: experiment.config.name.clone(),
                task: experiment.config.task.name(),
            });
        }
        let parameters = vary.into_iter();
        let parameters = parameters.map(|said| Parameter::parse(said, &experiment));
        let parameters = parameters.collect::<Result<Vec<_>, _>>()?;
        check_conflicts(&parameters)?;
        Ok(Self {
            seeds: generator(experiment.config.seed, 0, SEEDS),
            empty: draws_object.then(|| experiment.clone()),
            experiment,
            parameters,
        })
    }

    /// Returns the experiment of the latest episode.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// Sets up the episode that an environment reaches from the episode of `seed` after `following` resets without a
    /// seed. Returns its seed.
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

    /// Sets up the episode of `seed`, or of the next seed in the sequence that starts at the last given seed. Returns
    /// its seed.
    ///
    /// Varied values are the same as in trial 0 of a sweep with that seed.
    pub fn next(&mut self, seed: Option<u64>) -> Result<u64, EnvironmentError> {
        if let Some(seed) = seed {
            self.seeds = generator(seed, 0, SEEDS);
        }
        // TOML integers are signed, so a generated seed must fit into 63 bits.
        let seed = seed.unwrap_or_else(|| self.seeds.random::<u64>() >> 1);
        if let Some(empty) = &self.empty {
            self.experiment.clone_from(empty);
        }
        if !self.parameters.is_empty() {
            let draw = |p: &Parameter| {
                let mut stream = generator(seed, 0, &p.name);
                p.distribution.draw(&mut stream, p.whole)
            };
            let values: Vec<_> = self.parameters.iter().map(draw).collect();
            let settings = settings(self.parameters.iter().zip(&values))?;
            self.experiment = self.experiment.with_settings(&settings)?;
        }
        match self.empty {
            None => self.experiment.config.seed = seed,
            Some(_) => _ = place_random_object(&mut self.experiment.config, seed),
        }
        Ok(seed)
    }
}
