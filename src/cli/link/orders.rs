//! `feeler stop` and `feeler resume`: orders to a hand from anywhere.

use super::LinkArguments;
use crate::cli::{CommandError, Outcome};
use crate::link::beacon::Beacon;
use crate::link::endpoints::LinkError;
use crate::link::inbox::{Inbox, listen};
use crate::link::message::{Heartbeat, NO_FINGER, PROTOCOL, Resume, Stop};
use crate::link::network::Network;
use crate::link::outlet::{draw_instance, monotonic, send};
use crate::link::peers::{Expected, Peers};
use crate::link::rejection::Rejection;
use crate::link::shared::Shared;
use crate::link::topic::Topic;
use std::io::Write;
use std::sync::Arc;
use std::time::Duration;

/// How long to look for a hand.
const LONGEST: Duration = Duration::from_secs(5);

/// How often an order is said, and the time between.
const REPEATS: usize = 3;
const INTERVAL: Duration = Duration::from_millis(20);

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

/// Looks for other programs, and takes nothing else.
struct Lookout(Peers);

impl Inbox for Lookout {
    fn take(&mut self, _: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        self.0.heard(bytes, now).map(|_| ())
    }

    fn peers(&self) -> &Peers {
        &self.0
    }
}

impl Order {
    /// Says it once to whatever hand hears it, on behalf of `from`.
    pub fn send(self, network: &dyn Network, from: &str) -> Result<(), LinkError> {
        let (protocol, from) = (PROTOCOL, from.to_string());
        match self {
            Self::Stop => send(network, Topic::Stop, &Stop { protocol, from }),
            Self::Resume => send(network, Topic::Resume, &Resume { protocol, from }),
        }
    }
}

/// Says `order` to the hand of a rig.
pub fn order(
    arguments: &Arguments,
    order: Order,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let network = arguments.link.open(&arguments.rig, false)?;
    let clock = monotonic();
    let heartbeat = Heartbeat {
        instance: draw_instance(),
        program: "order".into(),
        finger: NO_FINGER,
        age: f64::NAN,
        ..Heartbeat::default()
    };
    let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
    let lookout = Shared::new(Lookout(Peers::new(Expected::default())));
    listen(&*network, &[Topic::Heartbeat], &lookout, &clock, &beacon)?;
    let is_hand = |lookout: &mut Lookout| {
        let mut peers = lookout.0.all().iter();
        peers.any(|peer| peer.heartbeat.program == "hand")
    };
    if !lookout.wait_for(LONGEST, is_hand) {
        let rig = &arguments.rig;
        return Err(format!("no hand of rig {rig:?} was heard within {LONGEST:?}").into());
    }
    // More than once: a message that the network cannot take is dropped.
    for _ in 0..REPEATS {
        order.send(&*network, &arguments.from)?;
        std::thread::sleep(INTERVAL);
    }
    writeln!(out, "said")?;
    Ok(Outcome::Done)
}
