//! `feeler view RIG`: shows a running rig of several programs.

use super::ServerOptions;
use super::feed::{Feed, Moment, Orders};
use super::source::serve;
use crate::rig::WatchedRig;
use crate::snapshot::{Snapshot, UNKNOWN};
use feeler_console::{CommandError, Outcome, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::live::{FingerRow, LiveRows, Row, write_phase};
use feeler_link::transport::{LinkError, Network};
use glam::{DQuat, DVec3};
use std::fmt::Write as _;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Sender name of a stop by the page.
const BY: &str = "the page of feeler view";
/// Interval at which received messages and orders are processed.
const INTERVAL: Duration = Duration::from_millis(10);

/// Serves the page of the rig named `rig`, which runs `experiment` and is connected by `network`, until Ctrl-C.
///
/// # Errors
/// If the page cannot be served or the network refuses to send or listen.
pub fn serve_rig(
    experiment: &Experiment,
    rig: &str,
    network: Arc<dyn Network>,
    options: ServerOptions,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let mut rows = LiveRows::new(&experiment.config)?;
    let interrupted = watch_for_interrupt()?;
    let mut watched = WatchedRig::new(experiment, rig, network)?;
    let title = format!("rig {rig}");
    let (feed, server) = serve(&title, &rows, BY, false, options, out)?;
    let watching = watch(&mut watched, &mut rows, &feed, &interrupted);
    feed.offer_last(|moment| {
        moment.words.clear();
        // Text that does not fit is cut off.
        let _ = match &watching {
            Ok(()) => write!(moment.words, "feeler view was ended"),
            Err(error) => write!(moment.words, "feeler view failed: {error}"),
        };
        let _ = write!(moment.words, "; the rig was left as it is.");
    });
    server.wait_for_last();
    watching?;
    Ok(Outcome::Done)
}

/// Shows received messages and sends orders until `interrupted`.
fn watch(
    watched: &mut WatchedRig,
    rows: &mut LiveRows,
    feed: &Feed,
    interrupted: &AtomicBool,
) -> Result<(), LinkError> {
    while !interrupted.load(Ordering::Relaxed) {
        watched.look();
        feed.offer(|moment| fill(moment, rows, watched));
        let Orders { stop, resume } = feed.orders();
        if resume {
            watched.resume(BY)?;
        }
        // A stop takes precedence over a resume.
        if let Some(by) = stop {
            watched.stop(&by)?;
        }
        thread::sleep(INTERVAL);
    }
    Ok(())
}

fn fill(moment: &mut Moment, rows: &mut LiveRows, watched: &WatchedRig) {
    let snapshot = watched.snapshot();
    moment.stopped = watched.is_stopped();
    moment.words.clear();
    // Text that does not fit is cut off.
    let _ = say(moment, &snapshot);
    moment.time = snapshot.time;
    let mut row = Row::begin(&mut moment.numbers);
    let phase = snapshot.task.map(|task| f64::from(u8::from(task.phase)));
    row.push(phase.unwrap_or(UNKNOWN));
    for (number, finger) in snapshot.fingers.iter().enumerate() {
        let contact = rows.contact(number, &finger.forces);
        row.finger(FingerRow {
            geometry: rows.geometry(number),
            joints: finger.joints,
            elements: finger.elements.len(),
            forces: finger.forces.iter().copied(),
            flags: &finger.flags,
            slips: false,
            shear_rates: &finger.shear_rates,
            contact,
        });
    }
    row.push(snapshot.torque.map_or(UNKNOWN, |torque| torque.newest));
    let instruments = watched.instruments();
    if rows.cap {
        let cap = instruments.map(|at| (at.cap_centre.into(), at.cap_angle));
        let (centre, angle) = cap.unwrap_or((DVec3::NAN, UNKNOWN));
        row.cap(centre, angle);
    }
    if rows.object {
        let object = instruments.filter(|at| at.has_object);
        let pose = object.map(|at| (at.object_position.into(), at.object_orientation.into()));
        let (position, rotation) = pose.unwrap_or((DVec3::NAN, DQuat::NAN));
        row.pose(position, rotation);
    }
}

/// Writes the current fault, or the phase of the hand, as text.
fn say(moment: &mut Moment, snapshot: &Snapshot) -> std::fmt::Result {
    let fault = snapshot.fault.as_ref().filter(|fault| !fault.over);
    match (fault, snapshot.task) {
        (Some(fault), _) => write!(moment.words, "{}.", fault.words),
        (None, _) if !snapshot.notice.is_empty() => write!(moment.words, "{}.", snapshot.notice),
        (None, None) => write!(moment.words, "No messages received from a hand."),
        (None, Some(task)) => write_phase(
            &mut moment.words,
            task.phase,
            task.stroke,
            task.strokes.unwrap_or_default(),
        ),
    }
}
