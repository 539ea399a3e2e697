//! Shows a rig until the user quits, or once, and sends orders on key presses.

use super::action::Action;
use super::text::text;
use super::view::View;
use crate::rig::WatchedRig;
use crate::snapshot::Snapshot;
use feeler_console::{CommandError, Outcome, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_link::transport::Network;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Sender name of orders that the user triggers by keys.
const BY: &str = "the keyboard of feeler top";
/// Interval at which received data and keys are checked.
const INTERVAL: Duration = Duration::from_millis(10);
/// Maximum time to wait for a rig that is shown once.
const LONGEST: Duration = Duration::from_secs(5);
/// Time to collect data before a single snapshot is shown: heartbeats arrive ten times per second.
const LISTENING: Duration = Duration::from_secs(1);
/// Columns and rows of the printed snapshot.
const PRINTED: (u16, u16) = (120, 40);

/// Shows the rig named `rig`, which runs `experiment` and is connected by `network`, until the user quits. If `once`,
/// prints one snapshot as text to `out` instead.
///
/// # Errors
/// If there is no terminal, no program of the rig was found in time, or the network refuses to send or listen.
pub fn show_rig(
    experiment: &Experiment,
    rig: &str,
    network: Arc<dyn Network>,
    once: bool,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let interrupted = watch_for_interrupt()?;
    let watched = WatchedRig::new(experiment, rig, network)?;
    if once {
        print(watched, &interrupted, out)
    } else {
        // The view sets the same flag when the user quits.
        let view = View::open(&interrupted)?;
        keep_showing(watched, view, &interrupted)
    }
}

fn keep_showing(
    mut watched: WatchedRig,
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
                // The view sets the flag itself.
                Action::Quit => {}
            }
        }
        thread::sleep(INTERVAL);
    }
    Ok(Outcome::Done)
}

fn print(
    mut watched: WatchedRig,
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
            let (rig, seconds) = (watched.rig(), LONGEST.as_secs());
            let failed = format!("no program of rig {rig:?} found within {seconds} s");
            return Err(failed.into());
        }
        if heard.is_none() && watched.hears_somebody() {
            heard = Some(Instant::now());
        }
        watched.look();
        thread::sleep(INTERVAL);
    }
    let (width, height) = PRINTED;
    // Keys have no effect.
    let snapshot = Snapshot {
        hand_listens: false,
        ..watched.snapshot()
    };
    for line in text(&snapshot, width, height).lines() {
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(Outcome::Done)
}
