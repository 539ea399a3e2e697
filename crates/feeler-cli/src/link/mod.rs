//! Programs of a networked rig, and the arguments that they share.

pub mod bench;
pub mod caller;
pub mod certificates;
mod door;
pub mod hand;
pub mod orders;
mod record;
pub mod rig;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod served_drives;
pub mod top;
pub mod world;

use super::CommandError;
use feeler_lab::config::Experiment;
use feeler_link::endpoints::{HAND_ENDPOINT, LinkConfig};
use feeler_link::network::{Network, Rehearsal, RehearsedNetwork};
use feeler_link::right::Right;
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
    rehearse: Option<Rehearsal>,
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

impl ListenArguments {
    /// Creates arguments that listen only at `endpoint`.
    fn at(endpoint: &str) -> Self {
        Self {
            listen: vec![endpoint.into()],
            insecure: false,
        }
    }

    /// Returns the endpoints to listen at.
    fn endpoints(&self) -> Vec<String> {
        given_or_default(&self.listen)
    }
}

/// Returns the given endpoints, or the default endpoint of a hand.
fn given_or_default(endpoints: &[String]) -> Vec<String> {
    match endpoints {
        [] => vec![HAND_ENDPOINT.into()],
        given => given.to_vec(),
    }
}

impl LinkArguments {
    /// Returns the endpoints of the hand.
    pub fn endpoints(&self) -> Vec<String> {
        given_or_default(&self.connect)
    }

    /// Creates arguments that connect to the hand at `endpoint`.
    fn connecting_to(endpoint: &str) -> Self {
        Self {
            connect: vec![endpoint.into()],
            ..Self::default()
        }
    }

    /// Returns the first option that was given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--connect", !self.connect.is_empty()),
            ("--certificates", self.certificates.is_some()),
            ("--rehearse", self.rehearse.is_some()),
        ];
        first_given(&options)
    }

    /// Returns the arguments with the folder of the first available certificate of `rights`, if certificates are
    /// used. Checks the certificate, and prints warnings about it on standard error.
    pub fn with_right(&self, rights: &[Right]) -> Result<Self, CommandError> {
        let mut arguments = self.clone();
        if let Some(folder) = &mut arguments.certificates {
            *folder = Right::folder_in(folder, rights);
            check_certificate(folder, rights)?;
        }
        Ok(arguments)
    }

    /// Opens the network of the rig `name` for a program that connects to the hand.
    pub fn connect(&self, name: &str) -> Result<Arc<dyn Network>, CommandError> {
        self.open(LinkConfig {
            rig: name.into(),
            connect: self.endpoints(),
            ..LinkConfig::default()
        })
    }

    /// Opens the network of the rig `name` for its hand, to which other programs connect.
    pub fn listen(
        &self,
        name: &str,
        listening: &ListenArguments,
    ) -> Result<Arc<dyn Network>, CommandError> {
        self.open(LinkConfig {
            rig: name.into(),
            is_hand: true,
            listen: listening.endpoints(),
            connect: self.connect.clone(),
            insecure: listening.insecure,
            ..LinkConfig::default()
        })
    }

    fn open(&self, config: LinkConfig) -> Result<Arc<dyn Network>, CommandError> {
        let network = open(&LinkConfig {
            certificates: self.certificates.clone(),
            ..config
        })?;
        Ok(match self.rehearse {
            Some(rehearsal) => Arc::new(RehearsedNetwork::new(network, rehearsal)),
            None => network,
        })
    }
}

/// Warns if a certificate expires soon; rejects one that is unusable.
#[cfg(feature = "link")]
fn check_certificate(folder: &Path, rights: &[Right]) -> Result<(), CommandError> {
    use std::io::Write as _;
    let own = feeler_link::own_certificate::OwnCertificate::read(folder, rights)?;
    if let Some(warning) = own.warning() {
        // The certificate works even if standard error is closed.
        let _ = writeln!(std::io::stderr(), "{warning}");
    }
    Ok(())
}

/// Does nothing: this build uses no certificates.
#[cfg(not(feature = "link"))]
fn check_certificate(_: &Path, _: &[Right]) -> Result<(), CommandError> {
    Ok(())
}

#[cfg(feature = "link")]
fn open(config: &LinkConfig) -> Result<Arc<dyn Network>, CommandError> {
    Ok(Arc::new(feeler_link::transport::Link::open(config)?))
}

#[cfg(not(feature = "link"))]
fn open(config: &LinkConfig) -> Result<Arc<dyn Network>, CommandError> {
    config.check()?;
    Err("this program was built without the link; build it with --features link".into())
}

/// Arguments that modify the experiment; they must be the same for all programs of a rig.
#[derive(Debug, Clone, clap::Args)]
pub struct ExperimentArguments {
    /// Random seed.
    #[arg(long, value_parser = crate::trials::parse_seed)]
    pub seed: Option<u64>,
    /// Source of forces: `image` (rendered camera images) or `direct` (simulated forces plus noise).
    #[arg(long, value_parser = ["image", "direct"])]
    pub sensing: Option<String>,
    /// Override an experiment value, e.g. control.slip_threshold=2.5. Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
    /// Name of the rig; programs with the same name communicate [default: the experiment's name]
    #[arg(long, value_name = "NAME", help_heading = "Link")]
    pub rig: Option<String>,
}

impl ExperimentArguments {
    /// Returns the name of the rig: the given one, or the experiment's.
    pub fn rig(&self, experiment: &Experiment) -> String {
        let name = || experiment.config.name.clone();
        self.rig.clone().unwrap_or_else(name)
    }

    /// Returns the first option that was given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--set", !self.settings.is_empty()),
            ("--seed", self.seed.is_some()),
            ("--sensing", self.sensing.is_some()),
            ("--rig", self.rig.is_some()),
        ];
        first_given(&options)
    }

    /// Returns the settings given on the command line; dedicated flags come last.
    pub fn settings(&self) -> Vec<String> {
        let seed = self.seed.map(|seed| format!("seed={seed}"));
        let sensing = self.sensing.as_ref().map(|s| format!("sensing={s}"));
        let named = seed.into_iter().chain(sensing);
        self.settings.iter().cloned().chain(named).collect()
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
