//! Uncertain values of an identified hand, and random draws of them.

use super::TuneError;
use crate::config::{ConfigError, Experiment};
use crate::identify::{Estimate, FingerEstimates, Identified};
use crate::sweep::SweepError;
use crate::sweep::plan::parameter::{Parameter, settings};
use crate::sweep::plan::ranges;
use crate::sweep::plan::ranges::{Entry, Link};
use crate::sweep::trial::generator;
use rand::RngExt;
use std::path::Path;

/// Experiment whose plausible ranges are used for values that were not identified.
const RANGES: &str = "cap-closing";
/// Group of the ranges that depend on materials and manufacturing.
const GROUP: &str = "apparatus";
/// Maximum number of attempts per draw. Some draws are invalid, for example kinetic friction above static friction.
const ATTEMPTS: u64 = 100;

/// The uncertain values of a simulated hand, from which plausible hands are drawn.
pub struct Uncertainty {
    experiment: Experiment,
    parameters: Vec<Parameter>,
    seed: u64,
}

/// A plausible hand: the experiment with randomly drawn values of the uncertain parameters.
pub struct Draw {
    /// The experiment with the drawn values in `[sim]` and directly sensed forces.
    pub experiment: Experiment,
    /// Drawn values of the uncertain parameters, in the order of [`Uncertainty::names`].
    pub values: Vec<f64>,
}

impl Uncertainty {
    /// Describes the uncertainty of the experiment's hand: identified values vary within their 95 % intervals, all
    /// others within the plausible ranges of the group `apparatus`. The draws depend only on `seed`.
    ///
    /// # Errors
    /// If the experiment has no `[sim]`, or no cap on a thread.
    pub fn new(
        experiment: &Experiment,
        identified: &Identified,
        seed: u64,
    ) -> Result<Self, TuneError> {
        experiment.config.simulation()?;
        let Some((cap, ..)) = experiment.config.cap() else {
            return Err(TuneError::Untunable {
                name: experiment.config.name.clone(),
                message: "its [sim] has no object on a thread; expected a cap to simulate".into(),
            });
        };
        let known = identified_entries(identified, cap).into_iter();
        let known: Vec<Parameter> = known
            .filter_map(|entry| Parameter::of_entry(&entry, experiment).ok())
            .collect();
        let files: [&Path; 0] = [];
        let plausible = ranges::load(&files, RANGES)?.parameter.into_iter();
        let plausible = plausible.filter(|entry| entry.group == GROUP);
        // Ranges of keys that this experiment lacks are omitted.
        let plausible = plausible.filter_map(|e| Parameter::of_entry(&e, experiment).ok());
        let unknown = plausible.filter(|p| known.iter().all(|k| k.conflict(p).is_none()));
        let unknown: Vec<_> = unknown.collect();
        Ok(Self {
            experiment: experiment.clone(),
            parameters: known.into_iter().chain(unknown).collect(),
            seed,
        })
    }

    /// Names of the uncertain values.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|parameter| &*parameter.name)
    }

    /// Returns the draw with this index. Each draw has a separate seed of the run.
    ///
    /// # Errors
    /// If no valid experiment can be drawn.
    pub fn draw(&self, index: u64) -> Result<Draw, TuneError> {
        let mut attempt = 0;
        loop {
            match self.attempt(index, attempt)? {
                Ok(draw) => return Ok(draw),
                Err(error) if attempt >= ATTEMPTS => return Err(TuneError::NoHand(error)),
                Err(_) => attempt += 1,
            }
        }
    }

    fn attempt(
        &self,
        index: u64,
        attempt: u64,
    ) -> Result<Result<Draw, Box<ConfigError>>, SweepError> {
        let random = |name: &str| generator(self.seed, index, &format!("tune {attempt} {name}"));
        let draw = |p: &Parameter| p.distribution.draw(&mut random(&p.name), p.whole);
        let texts: Vec<String> = self.parameters.iter().map(draw).collect();
        let mut set = settings(self.parameters.iter().zip(&texts))?;
        let seed = random("").random::<u64>() >> 1;
        set.extend([format!("seed={seed}"), "sensing=direct".to_string()]);
        let values = texts.iter().map(|text| text.parse().unwrap_or(f64::NAN));
        let values = values.collect();
        let experiment = self.experiment.with_settings(&set);
        Ok(experiment
            .map(|experiment| Draw { experiment, values })
            .map_err(Box::new))
    }
}

/// Ranges of the identified values: uniform within the 95 % intervals, averaged over the fingers.
fn identified_entries(identified: &Identified, cap: &str) -> Vec<Entry> {
    let count = identified.finger.len() as f64;
    let mean = |estimate: fn(&FingerEstimates) -> &Estimate| {
        let sum = |end: fn(&Estimate) -> f64| {
            let ends = identified.finger.iter().map(|finger| end(estimate(finger)));
            ends.sum::<f64>() / count
        };
        (sum(|e| e.low), sum(|e| e.high))
    };
    let of = |estimate: &Estimate| (estimate.low, estimate.high);
    let object = &identified.object;
    let feeler = |key: &str| vec![format!("sim.feeler.{key}")];
    let noise = ["normal", "shear"].map(|axis| format!("sim.direct_sensing.{axis}_noise"));
    let part = |key: &str| vec![format!("sim.object.{cap}.{key}")];
    let entries = [
        (
            "normal stiffness",
            feeler("normal_stiffness"),
            mean(|f| &f.normal_stiffness),
        ),
        (
            "shear stiffness",
            feeler("shear_stiffness"),
            mean(|f| &f.shear_stiffness),
        ),
        (
            "static friction",
            feeler("static_friction"),
            mean(|f| &f.static_friction),
        ),
        (
            "kinetic friction",
            feeler("kinetic_friction"),
            mean(|f| &f.kinetic_friction),
        ),
        (
            "servo lag",
            vec!["sim.servo.lag".to_string()],
            mean(|f| &f.servo_lag),
        ),
        ("force noise", noise.to_vec(), mean(|f| &f.force_noise)),
        (
            "object radius",
            part("shape.cylinder.radius"),
            of(&object.radius),
        ),
        ("pivot x", part("position.0"), of(&object.pivot_x)),
        ("pivot y", part("position.1"), of(&object.pivot_y)),
    ];
    let entry = |(name, keys, (low, high)): (&str, Vec<String>, (f64, f64))| Entry {
        name: name.to_string(),
        group: "identified".to_string(),
        unit: String::new(),
        key: None,
        keys: keys
            .into_iter()
            .map(|key| Link { key, factor: 1.0 })
            .collect(),
        of: None,
        power: None,
        range: format!("uniform({low:?}, {high:?})"),
        why: "95 % interval of the identified value".to_string(),
    };
    entries.map(entry).into()
}
