//! Builds and serves the live page of a rig.

use super::ServerOptions;
use super::feed::Feed;
use super::server::{PageListener, Server};
use feeler_console::CommandError;
use feeler_lab::experiment::live::LiveRows;
use feeler_report::pages::{Live, live_page};
use std::io::Write;
use std::sync::Arc;

/// Number of rows that a page keeps: one minute.
const KEEP: usize = 30 * 60;

/// Serves the page of the rig with the given `rows` and prints its address. Orders from the page are sent in the name
/// of `by`; `felt` is `true` if the rumble and tone that it plays are recorded.
pub fn serve(
    title: &str,
    rows: &LiveRows,
    by: &'static str,
    felt: bool,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<(Arc<Feed>, Server), CommandError> {
    let feed = Arc::new(Feed::new(rows.width()));
    let door = PageListener::open(options.port)?;
    let live = Live {
        socket: door.address.socket(),
        keep: KEEP,
        orders: true,
        felt,
    };
    let url = door.address.url();
    let server = door.serve_live(live_page(title, &rows.rig(), live), Arc::clone(&feed), by)?;
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
