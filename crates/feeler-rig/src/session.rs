//! Experiment and link of a program of a rig.

use crate::link_options::LinkOptions;
use feeler_console::CommandError;
use feeler_lab::config::Experiment;
use feeler_link::security::Right;
use feeler_link::transport::Network;
use std::sync::Arc;

/// Experiment, name and link of a rig, with which each of its programs is started.
pub struct RigSession {
    /// Experiment that all programs of the rig run.
    pub experiment: Experiment,
    /// Name of the rig; programs of the same name communicate.
    pub name: String,
    /// Connection to the rig.
    pub link: LinkOptions,
}

impl RigSession {
    /// Connects to the hand of the rig with a certificate for one of `rights`, in order of preference.
    ///
    /// # Errors
    /// If no certificate grants one of the rights, or the network cannot be opened.
    pub fn connect(&self, rights: &[Right]) -> Result<Arc<dyn Network>, CommandError> {
        self.link.with_right(rights)?.connect(&self.name)
    }
}
