//! What a sweep is: everything that its trials follow from, as `sweep.toml` keeps it.

use super::SweepError;
use super::design::{Design, MAX_PARAMETERS, Scheme};
use super::parameter::{Parameter, check_conflicts, check_together};
use super::ranges::Entry;
use crate::config::{ConfigError, Experiment};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the plan in a sweep's folder.
pub const PLAN: &str = "sweep.toml";

/// Which trials of a sweep are this machine's: those with `trial % of == index - 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// From 1.
    pub index: u64,
    /// How many there are.
    pub of: u64,
}

impl Shard {
    /// All of a sweep.
    pub const WHOLE: Self = Self { index: 1, of: 1 };

    /// Whether a trial is of this shard.
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

/// All that the trials of a sweep follow from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Version of the program.
    pub version: String,
    /// SHA-256 of version, seed, trials, expressions, design, experiment and policy.
    pub hash: String,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Number of trials, of all shards.
    pub trials: u64,
    /// The `--vary` expressions.
    pub vary: Vec<String>,
    /// What the experiment was called.
    pub origin: String,
    /// The folder that the experiment's file names are relative to; none if it is built in.
    #[serde(default)]
    pub folder: Option<PathBuf>,
    /// The experiment as run but for what varies (TOML).
    pub experiment: String,
    /// SHA-256 of the policy's file, if the experiment names one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy: Option<String>,
    /// Which trials this folder has.
    pub shard: Shard,
    /// How the trials lie in the space of `parameter`; without it, each draws by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design: Option<Design>,
    /// What a design varies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameter: Vec<Entry>,
}

impl Plan {
    /// The plan of a design that varies `parameter` in an experiment that is called `origin`.
    ///
    /// # Errors
    /// As [`Self::new`].
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

    /// The design's scheme, if there is one.
    pub fn scheme(&self) -> Option<Scheme> {
        Some(Scheme::new(self.design?, &self.parameter))
    }

    /// The plan to vary `vary` in an experiment that is called `origin`.
    ///
    /// # Errors
    /// When the policy that the experiment names cannot be read.
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

    /// Reads the plan in a sweep's folder.
    ///
    /// # Errors
    /// When there is none, or it was changed or made by another version.
    pub fn read(folder: &Path) -> Result<Self, SweepError> {
        let path = folder.join(PLAN);
        let text = fs::read_to_string(&path).map_err(|source| SweepError::File {
            path: path.clone(),
            source,
            note: "expected the folder of a sweep".to_string(),
        })?;
        Self::parse(&text, &path)
    }

    /// The plan that `text` says, which came from the file at `path` (for messages).
    ///
    /// # Errors
    /// When it is none, or was changed or made by another version.
    pub fn parse(text: &str, path: &Path) -> Result<Self, SweepError> {
        let wrong = |message: String| SweepError::Folder {
            path: path.to_path_buf(),
            message,
        };
        let plan: Self = toml::from_str(text).map_err(|e| wrong(e.to_string()))?;
        if plan.version != env!("CARGO_PKG_VERSION") {
            let (theirs, ours) = (&plan.version, env!("CARGO_PKG_VERSION"));
            return Err(wrong(format!(
                "made by version {theirs}, whose trials this version {ours} may not repeat"
            )));
        }
        if plan.hash != plan.computed_hash()
            || plan.shard.index == 0
            || plan.shard.index > plan.shard.of
        {
            return Err(wrong(
                "changed since the sweep was started: its hash differs".into(),
            ));
        }
        Ok(plan)
    }

    /// The plan of the sweep that was stopped in `folder`, which must be this one.
    ///
    /// # Errors
    /// When there is none, or it differs: names the first difference.
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
                message: format!(
                    "{difference}; expected the sweep that was stopped, of which nothing was changed"
                ),
            }),
        }
    }

    /// The text of `sweep.toml`.
    pub fn to_toml(&self) -> String {
        // Strings, numbers and lists of them: there is nothing that TOML could not say.
        toml::to_string(self).unwrap_or_default()
    }

    /// The experiment with its policy, and what varies in it.
    ///
    /// # Errors
    /// When either makes no sense, or the policy is another than the plan's.
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

    /// What differs from another plan of what should be the same sweep.
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
                differs.then(|| "it is of other ranges or another design".to_string())
            })
            .or_else(|| {
                let mut lines = self.experiment.lines().zip(other.experiment.lines());
                let differing = lines.find(|(ours, theirs)| ours != theirs);
                let line = differing.map_or(String::new(), |(ours, theirs)| {
                    format!(": {:?}, not {:?}", ours.trim(), theirs.trim())
                });
                (self.experiment != other.experiment)
                    .then(|| format!("it is of another experiment{line}"))
            })
            .or_else(|| {
                let digits = |plan: &Self| plan.policy.clone().unwrap_or_default();
                (self.policy != other.policy).then(|| {
                    let (ours, theirs) = (digits(self), digits(other));
                    format!("it is of a policy of SHA-256 {ours}, not {theirs}")
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

/// The SHA-256 of `bytes`, in hexadecimal digits.
fn sha256(bytes: &[u8]) -> String {
    digits(Sha256::new_with_prefix(bytes))
}

fn digits(hash: Sha256) -> String {
    let bytes = hash.finalize();
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
