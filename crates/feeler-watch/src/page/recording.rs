//! `feeler view RUN`: shows the report of a recording.

use super::ServerOptions;
use super::server::PageListener;
use super::source::print_url;
use feeler_console::{CommandError, Outcome, Reading, watch_for_interrupt};
use feeler_report::run::make::page_of_file;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

/// Interval between checks for Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);

/// Serves the report of the recording at `path` until Ctrl-C.
pub fn serve_recording(
    path: &Path,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let reading = Reading::new();
    let page = page_of_file(path, &mut |share| reading.show(share))?;
    drop(reading);
    let interrupted = watch_for_interrupt()?;
    let door = PageListener::open(options.port)?;
    let url = door.address.url();
    let _server = door.serve_recording(page, path.into())?;
    print_url(&url, options, out)?;
    while !interrupted.load(Ordering::Relaxed) {
        thread::sleep(PATIENCE);
    }
    Ok(Outcome::Done)
}
