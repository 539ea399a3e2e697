//! The policy's file that an experiment may name as its control law.

use super::error::ConfigError;
use super::load::{Experiment, read_bytes};
use feeler::control::controller::ControlConfig;
use feeler::control::law::LawConfig;
use feeler::control::law::policy::{MAX_BYTES, PolicyConfig, PolicyModel};
use feeler_record::PolicyFile;
use std::sync::Arc;

impl Experiment {
    /// The same experiment with this policy's file in place of that in its folder, if it is the one that it names.
    #[must_use]
    pub fn with_policy(mut self, policy: Option<PolicyFile>) -> Self {
        self.policy = policy;
        self
    }

    /// The file of the policy that the experiment names; none under another law.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn policy_file(&self) -> Result<Option<PolicyFile>, ConfigError> {
        let LawConfig::Policy(PolicyConfig { file, .. }) = &self.config.control.law else {
            return Ok(None);
        };
        if let Some(own) = self.policy.as_ref().filter(|own| own.name == *file) {
            return Ok(Some(own.clone()));
        }
        let path = self.folder().join(file);
        let read = read_bytes(
            &path,
            MAX_BYTES as u64,
            "the file of a policy (safetensors)",
        );
        let bytes = read.map_err(|source| ConfigError::PolicyFile {
            file: file.clone(),
            source: Box::new(source),
        })?;
        Ok(Some(PolicyFile {
            name: file.clone(),
            bytes: bytes.into(),
        }))
    }

    /// What the controller is tuned by, with its policy, if it has one.
    ///
    /// # Errors
    /// When the policy's file cannot be read or is none.
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
