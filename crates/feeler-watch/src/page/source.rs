//! Builds and serves the live page of a rig.

use super::ServerOptions;
use super::feed::Feed;
use super::server::{PageListener, Server};
use feeler_console::CommandError;
use feeler_lab::config::ExperimentConfig;
use feeler_lab::experiment::run_facts;
use feeler_record::{RunFacts, SolidFrame};
use feeler_report::pages::{Live, LiveRig, live_page};
use std::io::Write;
use std::sync::Arc;

/// Number of rows that a page keeps: one minute.
const KEEP: usize = 30 * 60;

/// Constants of a rig.
pub struct Source {
    facts: RunFacts,
    homes: Vec<[f64; 3]>,
    /// Number of elements of each fingertip.
    pub elements: Vec<usize>,
    /// `true` if rows contain the pose of a cap.
    pub cap: bool,
    /// `true` if rows contain the pose of a carried object.
    pub object: bool,
}

impl Source {
    /// Reads the constants of the rig of `config`.
    pub fn new(config: &ExperimentConfig) -> Result<Self, CommandError> {
        let facts = run_facts(config)?;
        let elements = facts.hand.iter().map(|model| model.element_tips.len());
        let mut solids = facts.solids.iter();
        Ok(Self {
            homes: config.task.homes(),
            elements: elements.collect(),
            cap: config.cap().is_some(),
            object: solids.any(|solid| solid.frame == SolidFrame::Object),
            facts,
        })
    }

    fn rig(&self) -> LiveRig<'_> {
        LiveRig {
            facts: &self.facts,
            homes: &self.homes,
            cap: self.cap,
            object: self.object,
        }
    }
}

/// Serves the page of `source` and prints its address. Orders of the page are attributed to `by`.
pub fn serve(
    title: &str,
    source: &Source,
    by: &'static str,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<(Arc<Feed>, Server), CommandError> {
    let rig = source.rig();
    let numbers: usize = rig.columns().iter().map(|(_, width)| width).sum();
    // The time is not among these values.
    let feed = Arc::new(Feed::new(numbers - 1));
    let door = PageListener::open(options.port)?;
    let live = Live {
        socket: door.address.socket(),
        keep: KEEP,
        orders: true,
    };
    let url = door.address.url();
    let server = door.serve_live(live_page(title, &rig, live), Arc::clone(&feed), by)?;
    print_url(&url, options, out)?;
    Ok((feed, server))
}

/// Prints the address of a page, and opens it unless `--no-open` is given.
pub fn print_url(
    url: &str,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    writeln!(out, "live page: {url}")?;
    out.flush()?;
    if options.open {
        // Without a browser, the user can still open the printed address.
        let _ = open::that_detached(url);
    }
    Ok(())
}
