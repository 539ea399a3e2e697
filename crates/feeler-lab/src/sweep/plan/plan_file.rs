//! The plan of a sweep: all inputs that determine its trials, stored as `sweep.toml`.

use super::design::{Design, MAX_PARAMETERS, Scheme};
use super::parameter::{Parameter, check_conflicts, check_together};
use super::ranges::Entry;
use crate::config::{ConfigError, Experiment};
use crate::sweep::SweepError;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the plan file in the folder of a sweep.
pub const PLAN: &str = "sweep.toml";

/// Part of a sweep that one machine runs: the trials with `trial % of == index - 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Index of the shard, starting at 1.
    pub index: u64,
    /// Number of shards.
    pub of: u64,
}

impl Shard {
    /// The only shard of an undivided sweep.
    pub const WHOLE: Self = Self { index: 1, of: 1 };

    /// Returns `true` if the trial belongs to this shard.
    pub fn has(self, trial: u64) -> bool {
        trial % self.of == self.index - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(index, of)| {
            let (index, of) = (index.parse().ok()?, of.parse().ok()?);
            (1 <= index && index <= of).then_some(Self { index, of })
        });
        numbers.ok_or_else(|| "expected i/n with i from 1 to n, as in 2/3".to_string())
    }
}

/// All inputs that determine the trials of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Version of the program.
    pub version: String,
    /// SHA-256 of version, seed, number of trials, expressions, design, experiment and policy.
    pub hash: String,
    /// Seed of the sweep.
    pub seed: u64,
    /// Total number of trials in all shards.
    pub trials: u64,
    /// The `--vary` expressions.
    pub vary: Vec<String>,
    /// Name of the experiment as given by the user.
    pub origin: String,
    /// Folder that file names in the experiment are relative to. `None` for a built-in experiment.
    #[serde(default)]
    pub folder: Option<PathBuf>,
    /// Text of the experiment (TOML) with all fixed settings applied.
    pub experiment: String,
    /// SHA-256 of the policy file, if the experiment uses one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy: Option<String>,
    /// Shard in this folder.
    pub shard: Shard,
    /// Sampling design over the parameters in `parameter`. `None` if each trial samples its values independently.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design: Option<Design>,
    /// Parameters varied by the design.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameter: Vec<Entry>,
}

impl Plan {
    /// Creates the plan of a design that varies `parameter` in `experiment`, which the user called `origin`.
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn designed(
        experiment: &Experiment,
        origin: &str,
        parameter: Vec<Entry>,
        design: Design,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        let trials = Scheme::new(design, &parameter).trials();
        let mut plan = Self {
            design: Some(design),
            parameter,
            ..Self::new(experiment, origin, &[], seed, trials)?
        };
        plan.hash = plan.computed_hash();
        Ok(plan)
    }

    /// Returns `true` if `trial` is one of the trials in this folder.
    pub fn has(&self, trial: u64) -> bool {
        trial < self.trials && self.shard.has(trial)
    }

    /// Returns the design applied to the parameters, if the plan has a design.
    pub fn scheme(&self) -> Option<Scheme> {
        Some(Scheme::new(self.design?, &self.parameter))
    }

    /// Creates the plan of a sweep with the `--vary` expressions `vary` in `experiment`, which the user called
    /// `origin`.
    ///
    /// # Errors
    /// If the policy file cannot be read.
    pub fn new(
        experiment: &Experiment,
        origin: &str,
        vary: &[String],
        seed: u64,
        trials: u64,
    ) -> Result<Self, ConfigError> {
        let folder = experiment.folder();
        let is_file =
            Path::new(origin).exists() && !crate::config::BUILT_IN.iter().any(|b| b.name == origin);
        let folder = is_file.then(|| match folder.as_os_str().is_empty() {
            true => PathBuf::from("."),
            false => folder.to_path_buf(),
        });
        let mut plan = Self {
            version: env!("CARGO_PKG_VERSION").to_string(),
            hash: String::new(),
            seed,
            trials,
            vary: vary.to_vec(),
            origin: origin.to_string(),
            folder: folder.map(|f| fs::canonicalize(&f).unwrap_or(f)),
            experiment: experiment.toml.clone(),
            policy: experiment
                .policy_file()?
                .map(|policy| sha256(&policy.bytes)),
            shard: Shard::WHOLE,
            design: None,
            parameter: Vec::new(),
        };
        plan.hash = plan.computed_hash();
        Ok(plan)
    }

    /// Reads the plan in the folder of a sweep.
    ///
    /// # Errors
    /// If there is no plan, or it was modified or written by another version.
    pub fn read(folder: &Path) -> Result<Self, SweepError> {
        let path = folder.join(PLAN);
        let note = "expected the folder of a sweep";
        let text = fs::read_to_string(&path).map_err(SweepError::file(&path, note))?;
        Self::parse(&text, &path)
    }

    /// Parses a plan. `path` is used in error messages.
    ///
    /// # Errors
    /// If the text is not a plan, or was modified or written by another version.
    pub fn parse(text: &str, path: &Path) -> Result<Self, SweepError> {
        let wrong = |message: String| SweepError::Folder {
            path: path.to_path_buf(),
            message,
        };
        let plan: Self = toml::from_str(text).map_err(|e| wrong(e.to_string()))?;
        if plan.version != env!("CARGO_PKG_VERSION") {
            let (theirs, ours) = (&plan.version, env!("CARGO_PKG_VERSION"));
            return Err(wrong(format!(
                "created by version {theirs}; version {ours} may not reproduce its trials"
            )));
        }
        if plan.hash != plan.computed_hash()
            || plan.shard.index == 0
            || plan.shard.index > plan.shard.of
        {
            return Err(wrong(
                "the plan was modified after the sweep was started: its hash differs".into(),
            ));
        }
        Ok(plan)
    }

    /// Reads the plan of the stopped sweep in `folder` and verifies that it equals this plan.
    ///
    /// # Errors
    /// If there is no plan, or it differs. The error describes the first difference.
    pub fn resume(&self, folder: &Path) -> Result<Self, SweepError> {
        let kept = Self::read(folder)?;
        let shard = |p: &Self| format!("{}/{}", p.shard.index, p.shard.of);
        let difference = kept.difference(self).or_else(|| {
            let (ours, theirs) = (shard(&kept), shard(self));
            (ours != theirs).then(|| format!("it is shard {ours}, not {theirs}"))
        });
        match difference {
            None => Ok(kept),
            Some(difference) => Err(SweepError::Folder {
                path: folder.to_path_buf(),
                message: format!("{difference}; expected the interrupted sweep, unchanged"),
            }),
        }
    }

    /// Returns the text of `sweep.toml`.
    pub fn to_toml(&self) -> String {
        // The plan contains only strings, numbers and lists, which TOML can always represent.
        toml::to_string(self).unwrap_or_default()
    }

    /// Loads the experiment with its policy, and the varied parameters.
    ///
    /// # Errors
    /// If either is invalid, or the policy file has changed.
    pub fn load(&self) -> Result<(Experiment, Vec<Parameter>), SweepError> {
        let experiment =
            Experiment::parse(&self.experiment, &self.origin, &[], self.folder.clone())?;
        let policy = experiment.policy_file()?;
        if let Some(policy) = &policy {
            let (actual, expected) = (sha256(&policy.bytes), self.policy.clone());
            if expected.as_ref() != Some(&actual) {
                return Err(SweepError::Policy {
                    file: policy.name.clone(),
                    expected: expected.unwrap_or_default(),
                    actual,
                });
            }
        }
        let experiment = experiment.with_policy(policy);
        let varied = self.vary.iter().map(|e| Parameter::parse(e, &experiment));
        let entries = self
            .parameter
            .iter()
            .map(|e| Parameter::of_entry(e, &experiment));
        let parameters = varied.chain(entries).collect::<Result<Vec<_>, _>>()?;
        check_conflicts(&parameters)?;
        if self.design.is_some() {
            if !(1..=MAX_PARAMETERS).contains(&parameters.len()) {
                let count = parameters.len();
                return Err(SweepError::Vary {
                    said: "--ranges".to_string(),
                    message: format!("{count} parameters; expected 1 to {MAX_PARAMETERS}"),
                });
            }
            check_together(&parameters, &experiment)?;
        }
        Ok((experiment, parameters))
    }

    /// Describes the first difference from another plan of supposedly the same sweep. `None` if they are equal.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let numbers = |what: &str, ours: u64, theirs: u64| {
            (ours != theirs).then(|| format!("its {what} is {ours}, not {theirs}"))
        };
        numbers("seed", self.seed, other.seed)
            .or_else(|| numbers("number of trials", self.trials, other.trials))
            .or_else(|| {
                let (ours, theirs) = (self.vary.join(" "), other.vary.join(" "));
                (ours != theirs).then(|| format!("it varies {ours:?}, not {theirs:?}"))
            })
            .or_else(|| {
                let differs = self.design != other.design || self.parameter != other.parameter;
                differs.then(|| "its ranges or its design differ".to_string())
            })
            .or_else(|| {
                let mut lines = self.experiment.lines().zip(other.experiment.lines());
                let differing = lines.find(|(ours, theirs)| ours != theirs);
                let line = differing.map_or(String::new(), |(ours, theirs)| {
                    format!(": {:?}, not {:?}", ours.trim(), theirs.trim())
                });
                (self.experiment != other.experiment)
                    .then(|| format!("its experiment differs{line}"))
            })
            .or_else(|| {
                let digits = |plan: &Self| plan.policy.clone().unwrap_or_default();
                (self.policy != other.policy).then(|| {
                    let (ours, theirs) = (digits(self), digits(other));
                    format!("its policy has the SHA-256 {ours}, not {theirs}")
                })
            })
            .or_else(|| (self.hash != other.hash).then(|| "its hash differs".to_string()))
    }

    fn computed_hash(&self) -> String {
        let mut hash = Sha256::new();
        let numbers = [self.seed.to_string(), self.trials.to_string()];
        let texts = [&self.version, &self.experiment]
            .into_iter()
            .chain(&numbers);
        let designed = (self.design.iter().map(|design| format!("{design:?}")))
            .chain(self.parameter.iter().map(|entry| format!("{entry:?}")));
        let texts = texts.chain(&self.vary).cloned().chain(designed);
        for text in texts.chain(self.policy.clone()) {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text.as_bytes());
        }
        digits(hash)
    }
}

/// SHA-256 of `bytes` as hexadecimal digits.
fn sha256(bytes: &[u8]) -> String {
    digits(Sha256::new_with_prefix(bytes))
}

fn digits(hash: Sha256) -> String {
    let bytes = hash.finalize();
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
