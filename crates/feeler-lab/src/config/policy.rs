//! The policy file that an experiment may use as its control law.

use super::error::ConfigError;
use super::load::Experiment;
use super::read::read_at_most;
use feeler::control::ControlConfig;
use feeler::control::law::LawConfig;
use feeler::control::law::policy::{MAX_BYTES, PolicyConfig, PolicyModel};
use feeler_record::PolicyFile;
use std::sync::Arc;

impl Experiment {
    /// Uses `policy` instead of the file in the experiment's folder if the experiment refers to a policy of that name.
    #[must_use]
    pub fn with_policy(mut self, policy: Option<PolicyFile>) -> Self {
        self.policy = policy;
        self
    }

    /// Reads the policy file of the experiment. Returns `None` if the experiment uses another law.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn policy_file(&self) -> Result<Option<PolicyFile>, ConfigError> {
        let LawConfig::Policy(PolicyConfig { file, .. }) = &self.config.control.law else {
            return Ok(None);
        };
        if let Some(own) = self.policy.as_ref().filter(|own| own.name == *file) {
            return Ok(Some(own.clone()));
        }
        let path = self.folder().join(file);
        let read = read_at_most(&path, MAX_BYTES as u64);
        let bytes = read.map_err(|source| ConfigError::PolicyFile {
            file: file.clone(),
            source: Box::new(ConfigError::Read {
                path,
                expected: "the file of a policy (safetensors)",
                source,
            }),
        })?;
        Ok(Some(PolicyFile {
            name: file.clone(),
            bytes: bytes.into(),
        }))
    }

    /// Returns the configuration of the controller, with the policy loaded if the law is a policy.
    ///
    /// # Errors
    /// If the policy file cannot be read or is invalid.
    pub fn control(&self) -> Result<ControlConfig, ConfigError> {
        let mut control = self.config.control.clone();
        if let (LawConfig::Policy(policy), Some(file)) = (&mut control.law, self.policy_file()?) {
            let model = PolicyModel::from_bytes(&file.bytes);
            let model = model.map_err(|source| ConfigError::Policy {
                file: file.name,
                source: Box::new(source),
            })?;
            policy.model = Some(Arc::new(model));
        }
        Ok(control)
    }
}
