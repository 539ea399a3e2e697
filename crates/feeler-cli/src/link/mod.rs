//! Programs of one rig: what their command lines have in common.

pub mod bench;
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

impl ListenArguments {
    /// At `endpoint` alone.
    fn at(endpoint: &str) -> Self {
        Self {
            listen: vec![endpoint.into()],
            insecure: false,
        }
    }

    /// Where to listen.
    fn endpoints(&self) -> Vec<String> {
        given_or_default(&self.listen)
    }
}

/// The endpoints that are given, or where a hand is unless told otherwise.
fn given_or_default(endpoints: &[String]) -> Vec<String> {
    match endpoints {
        [] => vec![HAND_ENDPOINT.into()],
        given => given.to_vec(),
    }
}

impl LinkArguments {
    /// Where the hand is.
    pub fn endpoints(&self) -> Vec<String> {
        given_or_default(&self.connect)
    }

    /// Of a program whose hand is at `endpoint`.
    fn connecting_to(endpoint: &str) -> Self {
        Self {
            connect: vec![endpoint.into()],
            ..Self::default()
        }
    }

    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--connect", !self.connect.is_empty()),
            ("--certificates", self.certificates.is_some()),
            ("--rehearse", self.rehearse.is_some()),
        ];
        first_given(&options)
    }

    /// The same with the certificate that gives one of `rights`, the first one first, where certificates are named.
    /// It is looked at, and what is to be said of it is said on standard error.
    pub fn with_right(&self, rights: &[Right]) -> Result<Self, CommandError> {
        let mut arguments = self.clone();
        if let Some(folder) = &mut arguments.certificates {
            *folder = Right::folder_in(folder, rights);
            check_certificate(folder, rights)?;
        }
        Ok(arguments)
    }

    /// The network of the rig `name`, of a program that looks for the hand.
    pub fn connect(&self, name: &str) -> Result<Arc<dyn Network>, CommandError> {
        self.open(LinkConfig {
            rig: name.into(),
            connect: self.endpoints(),
            ..LinkConfig::default()
        })
    }

    /// The network of the rig `name`, of its hand: it waits for the others to connect.
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

/// Warns of a certificate that expires soon, and refuses one that is of no use.
#[cfg(feature = "link")]
fn check_certificate(folder: &Path, rights: &[Right]) -> Result<(), CommandError> {
    use std::io::Write as _;
    let own = feeler_link::own_certificate::OwnCertificate::read(folder, rights)?;
    if let Some(warning) = own.warning() {
        // Where nobody listens, the certificate still works.
        let _ = writeln!(std::io::stderr(), "{warning}");
    }
    Ok(())
}

/// Without the link, no certificate is used.
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
