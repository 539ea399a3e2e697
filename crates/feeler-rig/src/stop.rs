//! The stop door: `feeler stop` without a connection, on the hand's side and on the caller's.

use crate::link_options::{LinkOptions, ListenOptions};
use feeler_console::Warnings;
use feeler_link::programs::Stopper;
use feeler_link::stop_wire::StopAnswer;
use std::sync::mpsc::{Receiver, channel};

/// Opens the stop door of the hand of `rig`. A hand that has none is stopped over its connections alone, and says so.
#[cfg(feature = "link")]
pub fn open_stop_door(
    link: &LinkOptions,
    listening: &ListenOptions,
    rig: &str,
    stopper: Stopper,
    warnings: &Warnings,
) -> Option<feeler_link::stop_door::StopDoor> {
    let answering = move |id, from: &str| {
        let (order, stands_still) = stopper.stop(id, from);
        let stopped = match stands_still {
            true => format!("told to stop by {from}"),
            false => String::new(),
        };
        StopAnswer { order, stopped }
    };
    let (endpoints, certificates) = (listening.endpoints(), link.certificates.as_deref());
    let opened = feeler_link::stop_door::StopDoor::open(&endpoints, certificates, rig, answering);
    opened
        .map_err(|error| warnings.queue(&format!("warning: {error}")))
        .ok()
}

/// Without the link there is no door.
#[cfg(not(feature = "link"))]
pub fn open_stop_door(
    _: &LinkOptions,
    _: &ListenOptions,
    _: &str,
    _: Stopper,
    _: &Warnings,
) -> Option<()> {
    None
}

/// Says the stop `id` by `from` at the stop door of the hand of `rig`, from a thread of its own; what it answers. Nothing
/// comes where it does not.
#[cfg(feature = "link")]
pub fn call_stop_door(link: &LinkOptions, rig: &str, id: u64, from: &str) -> Receiver<StopAnswer> {
    let (sender, receiver) = channel();
    let endpoints = link.endpoints();
    let (certificates, rig, from) = (link.certificates.clone(), rig.to_string(), from.to_string());
    std::thread::spawn(move || {
        let order = (id, from.as_str());
        let certificates = certificates.as_deref();
        // What the door refuses, the connection refuses, too, and says why.
        if let Ok(answer) = feeler_link::stop_call::call_stop(&endpoints, certificates, &rig, order)
        {
            // The program may have ended by what it heard over its connection.
            let _ = sender.send(answer);
        }
    });
    receiver
}

/// Without the link, nobody answers.
#[cfg(not(feature = "link"))]
pub fn call_stop_door(_: &LinkOptions, _: &str, _: u64, _: &str) -> Receiver<StopAnswer> {
    channel().1
}
