//! The page of a rig, made and served.

use super::ServerOptions;
use super::feed::Feed;
use super::server::{Door, Server};
use feeler_console::CommandError;
use feeler_lab::config::ExperimentConfig;
use feeler_lab::experiment::run_facts;
use feeler_record::{RunFacts, SolidFrame};
use feeler_report::live_page::{Live, LiveRig, live_page};
use std::io::Write;
use std::sync::Arc;

/// Rows that a page keeps: a minute of them.
const KEEP: usize = 30 * 60;

/// What is known of a rig before its first row.
pub struct Source {
    facts: RunFacts,
    homes: Vec<[f64; 3]>,
    /// Elements of each fingertip.
    pub elements: Vec<usize>,
    /// Whether rows say how a cap stands.
    pub cap: bool,
    /// Whether rows say where an object is that is carried.
    pub object: bool,
}

impl Source {
    /// Of the rig of `config`.
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

/// Serves the page of `source` and says where; its orders are given as from `by`.
pub fn serve(
    title: &str,
    source: &Source,
    by: &'static str,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<(Arc<Feed>, Server), CommandError> {
    let rig = source.rig();
    let numbers: usize = rig.columns().iter().map(|(_, width)| width).sum();
    // Time is not among them.
    let feed = Arc::new(Feed::new(numbers - 1));
    let door = Door::open(options.port)?;
    let live = Live {
        socket: door.address.socket(),
        keep: KEEP,
        orders: true,
    };
    let url = door.address.url();
    let server = door.serve_live(live_page(title, &rig, live), Arc::clone(&feed), by)?;
    say_where(&url, options, out)?;
    Ok((feed, server))
}

/// Says where a page is, and opens it unless told not to.
pub fn say_where(
    url: &str,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    writeln!(out, "live page: {url}")?;
    out.flush()?;
    if options.open {
        // Without a browser, the address is there.
        let _ = open::that_detached(url);
    }
    Ok(())
}
