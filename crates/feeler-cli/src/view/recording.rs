//! `feeler view RUN`: shows the report of a recording.

use super::ServerArguments;
use super::page::say_where;
use super::server::Door;
use crate::interrupt::watch_for_interrupt;
use crate::progress::Reading;
use crate::{CommandError, Outcome};
use feeler_report::make::page_of_file;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

/// Interval at which Ctrl-C is checked.
const PATIENCE: Duration = Duration::from_millis(50);

/// Serves the report of the recording at `path` until Ctrl-C.
pub fn view(
    path: &Path,
    arguments: &ServerArguments,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let reading = Reading::new();
    let page = page_of_file(path, &mut |share| reading.show(share))?;
    drop(reading);
    let interrupted = watch_for_interrupt()?;
    let door = Door::open(arguments.port)?;
    let url = door.address.url();
    let _server = door.serve_recording(page, path.into())?;
    say_where(&url, arguments, out)?;
    while !interrupted.load(Ordering::Relaxed) {
        thread::sleep(PATIENCE);
    }
    Ok(Outcome::Done)
}
