//! Programs of a networked rig, and the arguments that they share.

pub mod bench;
pub mod certificates;
pub mod hand;
pub mod orders;
pub mod rig;
pub mod top;
pub mod world;

use super::CommandError;
use crate::options::SettingArguments;
use feeler_lab::config::Experiment;
use feeler_link::transport::Impairment;
use feeler_rig::{LinkOptions, ListenOptions, RigSession};
use std::path::{Path, PathBuf};

/// Network arguments of a program.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Link")]
pub struct LinkArguments {
    /// Endpoint of the hand, e.g. tls/10.0.0.5:7447; retried until available [default: tcp/127.0.0.1:7447]
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,
    /// Folder of this computer's certificates, for tls/ endpoints; created by `feeler certificates`.
    ///
    /// Each program uses the certificate of its right.
    #[arg(long, value_name = "DIR")]
    certificates: Option<PathBuf>,
    /// Simulate an impaired network: loss, duplicate (0 to 1), delay, jitter (s), seed, e.g. loss=0.2,jitter=0.05
    #[arg(long, value_name = "FAULTS")]
    rehearse: Option<Impairment>,
}

/// Endpoints at which the hand listens.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Link")]
pub struct ListenArguments {
    /// Endpoint to listen at, e.g. tls/0.0.0.0:7447. Repeatable [default: tcp/127.0.0.1:7447]
    #[arg(long, value_name = "ENDPOINT")]
    listen: Vec<String>,
    /// Listen beyond this computer without certificates: anyone on the network can then move the hand.
    #[arg(long)]
    insecure: bool,
}

impl From<&ListenArguments> for ListenOptions {
    fn from(arguments: &ListenArguments) -> Self {
        Self {
            listen: arguments.listen.clone(),
            insecure: arguments.insecure,
        }
    }
}

impl From<&LinkArguments> for LinkOptions {
    fn from(arguments: &LinkArguments) -> Self {
        Self {
            connect: arguments.connect.clone(),
            certificates: arguments.certificates.clone(),
            impairment: arguments.rehearse,
        }
    }
}

impl LinkArguments {
    /// Returns the name of the first option on the command line, if any.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--connect", !self.connect.is_empty()),
            ("--certificates", self.certificates.is_some()),
            ("--rehearse", self.rehearse.is_some()),
        ];
        first_given(&options)
    }
}

/// Arguments that modify the experiment; they must be the same for all programs of a rig.
#[derive(Debug, Clone, clap::Args)]
pub struct ExperimentArguments {
    #[command(flatten)]
    pub changes: SettingArguments,
    /// Name of the rig; programs with the same name communicate [default: the experiment's name]
    #[arg(long, value_name = "NAME", help_heading = "Link")]
    pub rig: Option<String>,
}

impl ExperimentArguments {
    /// Session of the rig that runs the experiment `name`.
    pub fn session(&self, name: &str, link: &LinkArguments) -> Result<RigSession, CommandError> {
        let experiment = Experiment::load(name, &self.changes.settings())?;
        Ok(RigSession {
            name: self.rig(&experiment),
            experiment,
            link: link.into(),
        })
    }

    /// Returns the name of the rig: the given one, or the experiment's.
    pub fn rig(&self, experiment: &Experiment) -> String {
        let name = || experiment.config.name.clone();
        self.rig.clone().unwrap_or_else(name)
    }

    /// Returns the name of the first of these options that is present on the command line, if any.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--set", !self.changes.settings.is_empty()),
            ("--seed", self.changes.seed.is_some()),
            ("--sensing", self.changes.sensing.is_some()),
            ("--rig", self.rig.is_some()),
        ];
        first_given(&options)
    }
}

/// Returns the name of a rig, given by name or by the experiment file that its programs use.
///
/// # Errors
/// If the file does not exist or is not an experiment.
pub fn rig_name(given: &str) -> Result<String, CommandError> {
    if Path::new(given).extension().is_some_and(|e| e == "toml") {
        return Ok(Experiment::load(given, &[])?.config.name);
    }
    Ok(given.to_string())
}

fn first_given(options: &[(&'static str, bool)]) -> Option<&'static str> {
    let given = options.iter().find(|(_, given)| *given);
    given.map(|(option, _)| *option)
}
