//! Connectionless `feeler stop`: the hand's stop server, and its client.

use crate::link_options::{LinkOptions, ListenOptions};
use feeler_console::Warnings;
use feeler_link::programs::Stopper;
use feeler_link::stop_server::wire::StopAnswer;
use std::sync::mpsc::{Receiver, channel};

/// Starts the stop server of the hand of `rig`. If that fails, prints a warning; the hand can then be stopped only
/// over its connections.
#[cfg(feature = "link")]
pub fn open_stop_server(
    link: &LinkOptions,
    listening: &ListenOptions,
    rig: &str,
    stopper: Stopper,
    warnings: &Warnings,
) -> Option<feeler_link::stop_server::StopServer> {
    let answering = move |id, from: &str| {
        let (order, stands_still) = stopper.stop(id, from);
        let stopped = match stands_still {
            true => format!("stop requested by {from}"),
            false => String::new(),
        };
        StopAnswer { order, stopped }
    };
    let (endpoints, certificates) = (listening.endpoints(), link.certificates.as_deref());
    let opened =
        feeler_link::stop_server::StopServer::open(&endpoints, certificates, rig, answering);
    opened
        .map_err(|error| warnings.queue(&format!("warning: {error}")))
        .ok()
}

/// Does nothing: this build has no link.
#[cfg(not(feature = "link"))]
pub fn open_stop_server(
    _: &LinkOptions,
    _: &ListenOptions,
    _: &str,
    _: Stopper,
    _: &Warnings,
) -> Option<()> {
    None
}

/// Sends the stop `id` from `from` to the stop server of the hand of `rig`, on a background thread. The answer
/// arrives through the returned channel, which closes without one if the hand does not answer.
#[cfg(feature = "link")]
pub fn call_stop_server(
    link: &LinkOptions,
    rig: &str,
    id: u64,
    from: &str,
) -> Receiver<StopAnswer> {
    let (sender, receiver) = channel();
    let endpoints = link.endpoints();
    let (certificates, rig, from) = (link.certificates.clone(), rig.to_string(), from.to_string());
    std::thread::spawn(move || {
        let order = (id, from.as_str());
        let certificates = certificates.as_deref();
        // An order that the stop server rejects is also rejected over the connection, with a reason.
        if let Ok(answer) =
            feeler_link::stop_server::call_stop(&endpoints, certificates, &rig, order)
        {
            // The receiver is gone if an answer over the connection ended the program first.
            let _ = sender.send(answer);
        }
    });
    receiver
}

/// Returns a closed channel: this build has no link.
#[cfg(not(feature = "link"))]
pub fn call_stop_server(_: &LinkOptions, _: &str, _: u64, _: &str) -> Receiver<StopAnswer> {
    channel().1
}
