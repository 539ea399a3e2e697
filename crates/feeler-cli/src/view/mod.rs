//! `feeler view`: shows a run, a recording or a rig of several programs in the browser.

#![cfg_attr(
    not(feature = "view"),
    allow(dead_code, reason = "this program has no live page")
)]

#[cfg(not(feature = "view"))]
mod no_live_run;

use super::link::{ExperimentArguments, LinkArguments};
use super::{CommandError, Outcome};
use std::io::Write;

#[cfg(feature = "view")]
pub use feeler_watch::LiveRun;
#[cfg(not(feature = "view"))]
pub use no_live_run::LiveRun;

/// Error message of a build without the live page.
#[cfg(not(feature = "view"))]
const MISSING: &str = "this program was built without the live page; build it with --features view";

/// Options of the page's server.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Page")]
pub struct ServerArguments {
    /// Port of the page on this computer; 0 selects a free port.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Print the page's address without opening a browser.
    #[arg(long)]
    pub no_open: bool,
}

#[cfg(feature = "view")]
impl From<&ServerArguments> for feeler_watch::ServerOptions {
    fn from(arguments: &ServerArguments) -> Self {
        Self {
            port: arguments.port,
            open: !arguments.no_open,
        }
    }
}

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Recording (folder of a run, or a file *.mcap), or experiment of a rig of several programs.
    ///
    /// A folder or a path ending in .mcap is shown as a recording. All else is the experiment of a rig: a file or the
    /// name of a built-in one.
    what: String,
    #[command(flatten)]
    server: ServerArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Serves the page of a recording or of a rig.
#[cfg(feature = "view")]
pub fn view(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    use feeler_link::security::Right;
    use feeler_report::run::RECORDING;
    use std::path::Path;
    let path = Path::new(&arguments.what);
    if !path.is_dir() && path.extension().is_none_or(|extension| extension != "mcap") {
        let session = arguments.values.session(&arguments.what, &arguments.link)?;
        let network = session.connect(&[Right::Order, Right::Watch])?;
        return feeler_watch::serve_rig(
            &session.experiment,
            &session.name,
            network,
            (&arguments.server).into(),
            out,
        );
    }
    let given = arguments.values.given().or(arguments.link.given());
    if let Some(option) = given {
        let what = path.display();
        return Err(format!("{option} requires a rig, got the recording {what}").into());
    }
    let recording = match path.is_dir() {
        true => path.join(RECORDING),
        false => path.to_path_buf(),
    };
    feeler_watch::serve_recording(&recording, (&arguments.server).into(), out)
}

/// Returns an error, because this build has no live page.
#[cfg(not(feature = "view"))]
pub fn view(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err(format!("view {}: {MISSING}", arguments.what).into())
}
