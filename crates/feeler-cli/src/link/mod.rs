//! Programs of one rig: what their command lines have in common.

pub mod bench;
pub mod certificates;
pub mod hand;
pub mod orders;
pub mod rig;
pub mod top;
pub mod world;

use super::CommandError;
use feeler_lab::config::Experiment;
use feeler_link::network::Rehearsal;
use feeler_rig::{LinkOptions, ListenOptions, RigSession};
use std::path::{Path, PathBuf};

/// How a program takes part in the link.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Link")]
pub struct LinkArguments {
    /// Where the hand is, as in tls/10.0.0.5:7447; tried until it is there [default: tcp/127.0.0.1:7447]
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,
    /// Folder of this computer's certificates, for tls/ endpoints; `feeler certificates` makes them. Each program takes
    /// that of its right.
    #[arg(long, value_name = "DIR")]
    certificates: Option<PathBuf>,
    /// Rehearse a bad network: loss, duplicate (0 to 1), delay, jitter (s), seed, as in
    /// loss=0.2,jitter=0.05
    #[arg(long, value_name = "FAULTS")]
    rehearse: Option<Rehearsal>,
}

/// Where the hand listens.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Link")]
pub struct ListenArguments {
    /// Where to listen, as in tls/0.0.0.0:7447; several times for several places [default: tcp/127.0.0.1:7447]
    #[arg(long, value_name = "ENDPOINT")]
    listen: Vec<String>,
    /// Listen beyond this computer without certificates: anybody there can then move the hand.
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
    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--connect", !self.connect.is_empty()),
            ("--certificates", self.certificates.is_some()),
            ("--rehearse", self.rehearse.is_some()),
        ];
        first_given(&options)
    }
}

/// The experiment that all programs of a rig work by.
#[derive(Debug, Clone, clap::Args)]
pub struct ExperimentArguments {
    /// Random seed.
    #[arg(long, value_parser = crate::trials::parse_seed)]
    pub seed: Option<u64>,
    /// Where forces come from: rendered camera pictures, or the feelers themselves plus noise.
    #[arg(long, value_parser = ["image", "direct"])]
    pub sensing: Option<String>,
    /// Set any value of the experiment, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
    /// Name of the rig: programs of the same name hear each other [default: the experiment's name]
    #[arg(long, value_name = "NAME", help_heading = "Link")]
    pub rig: Option<String>,
}

impl ExperimentArguments {
    /// Session of the rig that runs the experiment `name`.
    pub fn session(&self, name: &str, link: &LinkArguments) -> Result<RigSession, CommandError> {
        let experiment = Experiment::load(name, &self.settings())?;
        Ok(RigSession {
            name: self.rig(&experiment),
            experiment,
            link: link.into(),
        })
    }

    /// Name of the rig, which is that of the experiment unless said otherwise.
    pub fn rig(&self, experiment: &Experiment) -> String {
        let name = || experiment.config.name.clone();
        self.rig.clone().unwrap_or_else(name)
    }

    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--set", !self.settings.is_empty()),
            ("--seed", self.seed.is_some()),
            ("--sensing", self.sensing.is_some()),
            ("--rig", self.rig.is_some()),
        ];
        first_given(&options)
    }

    /// What the command line sets, the named flags last.
    pub fn settings(&self) -> Vec<String> {
        let seed = self.seed.map(|seed| format!("seed={seed}"));
        let sensing = self.sensing.as_ref().map(|s| format!("sensing={s}"));
        let named = seed.into_iter().chain(sensing);
        self.settings.iter().cloned().chain(named).collect()
    }
}

/// The name of the rig that is `given` by it, or by the experiment file that its programs were started with.
///
/// # Errors
/// When there is no such file, or it is no experiment.
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
