//! Shows a rig until whoever watches leaves, or once; passes on what the keys say.

use super::{Action, View, text};
use crate::rig::Watched;
use crate::snapshot::Snapshot;
use feeler_console::watch_for_interrupt;
use feeler_console::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_link::network::Network;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Who stops the hand when a key is pressed.
const BY: &str = "the keyboard of feeler top";
/// Time between two looks at what was heard and at the keys.
const INTERVAL: Duration = Duration::from_millis(10);
/// How long a rig is waited for that is to be shown once.
const LONGEST: Duration = Duration::from_secs(5);
/// How long it is listened to then: heartbeats come ten times a second.
const LISTENING: Duration = Duration::from_secs(1);
/// Columns and rows of what is printed.
const PRINTED: (u16, u16) = (120, 40);

/// Shows the rig named `rig`, which runs `experiment` and is connected by `network`, until the user quits. If `once`,
/// prints one snapshot as text to `out` instead.
///
/// # Errors
/// If there is no terminal, no program of the rig was received in time, or the network refuses to send or listen.
pub fn show_rig(
    experiment: &Experiment,
    rig: &str,
    network: Arc<dyn Network>,
    once: bool,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let interrupted = watch_for_interrupt()?;
    let watched = Watched::new(experiment, rig, network)?;
    if once {
        print(watched, &interrupted, out)
    } else {
        // The view raises the same flag when whoever watches leaves.
        let view = View::open(&interrupted)?;
        keep_showing(watched, view, &interrupted)
    }
}

fn keep_showing(
    mut watched: Watched,
    mut view: View,
    leaving: &AtomicBool,
) -> Result<Outcome, CommandError> {
    while view.is_open() && !leaving.load(Ordering::Relaxed) {
        watched.look();
        view.show(|| watched.snapshot());
        for action in view.actions() {
            match action {
                Action::Stop => watched.stop(BY)?,
                Action::Resume => watched.resume(BY)?,
                // The view says that it is left.
                Action::Quit => {}
            }
        }
        thread::sleep(INTERVAL);
    }
    Ok(Outcome::Done)
}

fn print(
    mut watched: Watched,
    interrupted: &AtomicBool,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let begun = Instant::now();
    let mut heard: Option<Instant> = None;
    while heard.is_none_or(|heard| heard.elapsed() < LISTENING) {
        if interrupted.load(Ordering::Relaxed) {
            return Ok(Outcome::GivenUp);
        }
        if heard.is_none() && begun.elapsed() > LONGEST {
            let rig = watched.rig();
            let failed = format!("no program of rig {rig:?} was heard within {LONGEST:?}");
            return Err(failed.into());
        }
        if heard.is_none() && watched.hears_somebody() {
            heard = Some(Instant::now());
        }
        watched.look();
        thread::sleep(INTERVAL);
    }
    let (width, height) = PRINTED;
    // There are no keys.
    let snapshot = Snapshot {
        hand_listens: false,
        ..watched.snapshot()
    };
    for line in text(&snapshot, width, height).lines() {
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(Outcome::Done)
}
