//! The `feeler skins emulate` subcommand.

use super::EmulateArguments;
use crate::typed::typed_lines;
use crate::{CommandError, Outcome};
use feeler_console::watch_for_interrupt;
use feeler_sensing::{TaxelOptions, read_taxel_layout};
use feeler_sources::skin::{SkinEmulator, SkinEvent};
use std::io::Write;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// Interval between checks whether to stop.
const NAP: Duration = Duration::from_millis(50);
/// Value of `--event` that enables events from standard input.
const TYPED: &str = "-";

pub fn emulate(arguments: &EmulateArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let events = arguments.events.iter().filter(|event| *event != TYPED);
    let events = events.map(|event| event.parse());
    let events = events.collect::<Result<Vec<SkinEvent>, _>>();
    let events = events.map_err(|error| format!("--event {error}"))?;
    let layout = read_taxel_layout(&arguments.taxels, &TaxelOptions::default(), None)?;
    let interrupted = watch_for_interrupt()?;
    let emulator = SkinEmulator::start(&layout, arguments.rate, arguments.link.as_deref())?;
    for event in events {
        emulator.inject(event);
    }
    let typed = arguments.events.iter().any(|event| event == TYPED);
    let typed = typed.then(|| typed_lines("event"));
    writeln!(out, "{}", emulator.path())?;
    out.flush()?;
    while !interrupted.load(Ordering::Relaxed) {
        std::thread::sleep(NAP);
        for event in typed.iter().flat_map(Receiver::try_iter) {
            emulator.inject(event);
        }
    }
    Ok(Outcome::Done)
}
