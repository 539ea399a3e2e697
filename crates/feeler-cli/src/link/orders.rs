//! `feeler stop` and `feeler resume`: orders to a hand from anywhere.

use super::LinkArguments;
use crate::{CommandError, Outcome};
use feeler_link::beacon::Beacon;
use feeler_link::endpoints::LinkError;
use feeler_link::inbox::{Inbox, listen, read};
use feeler_link::message::{
    HandMode, Heartbeat, NO_FINGER, PROTOCOL, ProgramKind, ResumeMessage, StopMessage,
};
use feeler_link::network::Network;
use feeler_link::outlet::{draw_instance, monotonic, send};
use feeler_link::peers::{Expected, Peers};
use feeler_link::rejection::{Rejection, Rejections};
use feeler_link::right::Right;
use feeler_link::shared::Shared;
use feeler_link::topic::Topic;
use std::io::Write;
use std::sync::Arc;
use std::time::Duration;

/// How long to look for a hand.
const LONGEST: Duration = Duration::from_secs(5);

/// How often an order is said at most, and how long the hand may take to heed it before it is said again.
const REPEATS: usize = 5;
const INTERVAL: Duration = Duration::from_millis(200);

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Name of the rig: that of the experiment, unless its programs were given another.
    rig: String,
    /// Who says so, for the hand's screen and record.
    #[arg(long, default_value = "the command line")]
    from: String,
    #[command(flatten)]
    link: LinkArguments,
}

/// What there is to say to a hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Stand still.
    Stop,
    /// Go on.
    Resume,
}

/// Looks for the hand, and hears what it is about.
struct Lookout {
    peers: Peers,
    mode: Option<HandMode>,
    rejected: Rejections,
}

impl Inbox for Lookout {
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        if topic == Topic::Mode {
            self.mode = Some(read(bytes)?);
            return Ok(());
        }
        self.peers.heard(bytes, now).map(|_| ())
    }

    fn peers(&self) -> &Peers {
        &self.peers
    }

    fn rejected(&mut self) -> &mut Rejections {
        &mut self.rejected
    }
}

impl Order {
    /// Says it once to whatever hand hears it, on behalf of `from`.
    pub fn send(self, network: &dyn Network, from: &str) -> Result<(), LinkError> {
        let (protocol, from) = (PROTOCOL, from.to_string());
        match self {
            Self::Stop => send(network, Topic::Stop, &StopMessage { protocol, from }),
            Self::Resume => send(network, Topic::Resume, &ResumeMessage { protocol, from }),
        }
    }

    fn is_followed(self, mode: &HandMode) -> bool {
        mode.stopped.is_empty() == (self == Self::Resume)
    }
}

/// Says `order` to the hand of a rig, and whether it heeds it.
pub fn order(
    arguments: &Arguments,
    order: Order,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let rights: &[Right] = match order {
        Order::Stop => &[Right::Order, Right::Stop],
        Order::Resume => &[Right::Order],
    };
    let network = arguments
        .link
        .with_right(rights)?
        .open(&arguments.rig, false)?;
    let clock = monotonic();
    let heartbeat = Heartbeat {
        instance: draw_instance(),
        program: ProgramKind::Order,
        finger: NO_FINGER,
        age: f64::NAN,
        ..Heartbeat::default()
    };
    let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
    let lookout = Shared::new(Lookout {
        peers: Peers::new(Expected::default()),
        mode: None,
        rejected: Rejections::default(),
    });
    let topics = [Topic::Heartbeat, Topic::Mode];
    listen(&*network, &topics, &lookout, &clock, &beacon)?;
    let is_hand = |lookout: &mut Lookout| {
        let mut peers = lookout.peers.all().iter();
        peers.any(|peer| peer.heartbeat.program == ProgramKind::Hand)
    };
    if !lookout.wait_for(LONGEST, is_hand) {
        let rig = &arguments.rig;
        return Err(format!("no hand of rig {rig:?} was heard within {LONGEST:?}").into());
    }
    // More than once: a message that the network cannot take is dropped.
    for _ in 0..REPEATS {
        lookout.lock().mode = None;
        order.send(&*network, &arguments.from)?;
        let heeded =
            |lookout: &mut Lookout| lookout.mode.as_ref().is_some_and(|m| order.is_followed(m));
        if lookout.wait_for(INTERVAL, heeded) {
            let mode = lookout.lock().mode.clone().unwrap_or_default();
            return said(&mode, out);
        }
    }
    let mode = lookout.lock().mode.clone();
    not_followed(mode.as_ref(), out)
}

fn said(mode: &HandMode, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match mode.stopped.as_str() {
        "" => writeln!(out, "the hand goes on")?,
        reason => writeln!(out, "the hand stands still: {reason}")?,
    }
    Ok(Outcome::Done)
}

/// What is said of a hand that does not do as it was told.
fn not_followed(mode: Option<&HandMode>, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match mode {
        None => writeln!(
            out,
            "the hand was told to, but does not say whether it does"
        )?,
        // It heeds a stop when it begins.
        Some(mode) if mode.is_waiting() => {
            writeln!(
                out,
                "the hand waits for its rig, and will stand still when it is there"
            )?;
            return Ok(Outcome::Done);
        }
        Some(mode) if mode.stopped.is_empty() => writeln!(out, "the hand goes on")?,
        Some(mode) => writeln!(out, "the hand stays stopped: {}", mode.stopped)?,
    }
    Ok(Outcome::GivenUp)
}
