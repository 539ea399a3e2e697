//! The `feeler skins emulate` subcommand.

use super::EmulateArguments;
use crate::typed::given_and_typed;
use crate::{CommandError, Outcome};
use feeler_console::watch_for_interrupt;
use feeler_sensing::{TaxelOptions, read_taxel_layout};
use feeler_sources::skin::SkinEmulator;
use std::io::Write;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// Interval between checks whether to stop.
const NAP: Duration = Duration::from_millis(50);

pub fn emulate(arguments: &EmulateArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let (events, typed) = given_and_typed("event", &arguments.events)?;
    let layout = read_taxel_layout(&arguments.taxels, &TaxelOptions::default(), None)?;
    let interrupted = watch_for_interrupt()?;
    let emulator = SkinEmulator::start(&layout, arguments.rate, arguments.link.as_deref())?;
    for event in events {
        emulator.inject(event);
    }
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
