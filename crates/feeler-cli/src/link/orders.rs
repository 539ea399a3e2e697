//! The `feeler stop` and `feeler resume` subcommands.

use super::{LinkArguments, rig_name};
use crate::options::Json;
use crate::{CommandError, Outcome};
use feeler_console::print_json;
use feeler_link::hand::{Ack, HandClient, INTERVAL, Order, STEADY, stop_to_resume};
use feeler_link::messages::{HandMode, StopInForce};
use feeler_link::security::Right;
use feeler_link::stop_server::wire::StopAnswer;
use feeler_rig::{LinkOptions, call_stop_server};
use serde::Serialize;
use std::io::Write;
use std::time::{Duration, Instant};

/// Maximum time to find a hand and to receive its answer. A hand answers between two control steps, which may be long.
const LONGEST: Duration = Duration::from_secs(5);

/// Duration for which a stop order is repeated to a connected hand. If the hand does not confirm it within this time,
/// the answer of the stop server is used.
const DOOR_NEXT: Duration = Duration::from_secs(1);

/// Time to wait for a connection to the hand before the answer of the stop server is used.
const DOOR_FIRST: Duration = Duration::from_millis(500);

#[derive(Debug, clap::Args)]
pub struct StopArguments {
    /// Name of the rig (by default, that of the experiment), or the experiment file.
    rig: String,
    /// Name of the caller, displayed and recorded by the hand.
    #[arg(long, default_value = BY)]
    from: String,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    link: LinkArguments,
}

/// Result of a stop; output of `--json`.
#[derive(Default, Serialize)]
struct Stopped {
    /// `true` if the hand is stopped now.
    stands_still: bool,
    /// `true` if the hand is waiting for its rig, and will be stopped once the rig is connected.
    waits_for_rig: bool,
    /// Number to pass to `feeler resume --number` to clear this stop, or `None` if the hand did not assign one.
    number: Option<u64>,
    /// Reason given by the hand.
    reason: String,
    /// Summary in one sentence.
    message: String,
}

impl Stopped {
    /// Prints the result. The order succeeded if the hand is or will be stopped.
    fn print(&self, json: Json, out: &mut dyn Write) -> Result<Outcome, CommandError> {
        match json.json {
            true => print_json(self, out)?,
            false => writeln!(out, "{}", self.message)?,
        }
        Ok(match self.stands_still || self.waits_for_rig {
            true => Outcome::Done,
            false => Outcome::GivenUp,
        })
    }
}

#[derive(Debug, clap::Args)]
pub struct ResumeArguments {
    /// Name of the rig (by default, that of the experiment), or the experiment file.
    rig: String,
    /// Name of the caller whose stop to resume; if that caller has none, a stop by the hand itself is resumed [default:
    /// "the command line"]
    #[arg(long, default_value = BY, hide_default_value = true)]
    from: String,
    /// Number of the stop to resume, as printed by `feeler stop` and `feeler resume`.
    #[arg(long, conflicts_with = "from")]
    number: Option<u64>,
    #[command(flatten)]
    link: LinkArguments,
}

/// Name under which orders of the command line are displayed and recorded.
const BY: &str = "the command line";

/// Stops the hand of a rig, and prints whether it stopped.
pub fn stop(arguments: &StopArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    send_stop(arguments)?.print(arguments.json, out)
}

/// Stops the hand of a rig.
fn send_stop(arguments: &StopArguments) -> Result<Stopped, CommandError> {
    let link = LinkOptions::from(&arguments.link).with_right(&[Right::Order, Right::Stop])?;
    let rig = &rig_name(&arguments.rig)?;
    let (order, id) = Order::stop(&arguments.from);
    // Use both ways at once: the stop server answers even if connecting is impossible.
    let answers = call_stop_server(&link, rig, id, &arguments.from);
    let client = HandClient::new(link.connect(rig)?)?;
    if !client.wait_until(DOOR_FIRST, |_| true) {
        let start = Instant::now();
        while !client.wait_until(INTERVAL / 4, |_| true) {
            if let Ok(answer) = answers.try_recv() {
                return Ok(from_answer(answer));
            }
            if start.elapsed() > LONGEST {
                return Err(unheard(rig));
            }
        }
    }
    let holds = |mode: &HandMode| mode.stops.iter().any(|stop| stop.id == id);
    let is_so = |mode: &HandMode| holds(mode) && (mode.is_waiting() || !mode.stopped.is_empty());
    let heeded = client.order(&order, DOOR_NEXT, is_so)?;
    let mode = client.mode();
    let stop = mode.stops.iter().find(|stop| stop.id == id);
    let number = stop.map(|stop| stop.number);
    let words = number.unwrap_or(0);
    let unconfirmed = |message: &str| Stopped {
        message: message.to_string(),
        ..Stopped::default()
    };
    Ok(match heeded {
        // A waiting hand obeys the stop when it starts.
        Ack::Stable if mode.is_waiting() => Stopped {
            waits_for_rig: true,
            number,
            message: format!(
                "the hand is waiting for its rig and will hold still once the rig is connected (stop {words})"
            ),
            ..Stopped::default()
        },
        Ack::Stable => Stopped {
            stands_still: true,
            number,
            message: format!(
                "the hand is stopped: {} (stop {words}, confirmed for {STEADY:?})",
                mode.stopped
            ),
            reason: mode.stopped,
            ..Stopped::default()
        },
        Ack::Reverted => unconfirmed("the hand stopped, but another client resumed it at once"),
        Ack::None => match answers.recv_timeout(LONGEST) {
            Ok(answer) => from_answer(answer),
            Err(_) => unconfirmed("the hand did not confirm the stop"),
        },
    })
}

/// Interprets the answer of the stop server.
fn from_answer(answer: StopAnswer) -> Stopped {
    let (number, reason) = (answer.order, answer.stopped);
    Stopped {
        stands_still: !reason.is_empty(),
        waits_for_rig: false,
        number: Some(number),
        message: match reason.as_str() {
            "" => format!(
                "the hand accepted stop {number}, but it is not in force: another client resumed the hand, or the hand is not responding"
            ),
            stopped => {
                format!(
                    "the hand is stopped: {stopped} (stop {number}, confirmed by the stop server)"
                )
            }
        },
        reason,
    }
}

fn unheard(rig: &str) -> CommandError {
    let seconds = LONGEST.as_secs();
    format!("no hand of rig {rig:?} found within {seconds} s").into()
}

/// Sends a resume order to the hand of a rig, and prints whether the hand continues.
pub fn resume(arguments: &ResumeArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let rig = &rig_name(&arguments.rig)?;
    let client = HandClient::new(
        LinkOptions::from(&arguments.link)
            .with_right(&[Right::Order])?
            .connect(rig)?,
    )?;
    if !client.wait_until(LONGEST, |_| true) {
        return Err(unheard(rig));
    }
    let stops = client.mode().stops;
    if stops.is_empty() {
        writeln!(out, "the hand is not stopped")?;
        return Ok(Outcome::Done);
    }
    let named = |number| stops.iter().find(|stop| stop.number == number);
    let (chosen, expected) = match arguments.number {
        Some(number) => (
            named(number),
            format!("--number {number}: expected the number of one of these stops"),
        ),
        None => (
            stop_to_resume(&stops, &arguments.from),
            "none of these stops is by this caller; choose one with --number".into(),
        ),
    };
    let Some(stop) = chosen else {
        return Err(format!("{expected}\n{}", list(&stops)).into());
    };
    let number = stop.number;
    let is_so = |mode: &HandMode| mode.stops.iter().all(|stop| stop.number != number);
    let order = Order::resume(&arguments.from, number);
    let heeded = client.order(&order, LONGEST, is_so)?;
    if matches!(heeded, Ack::None) {
        writeln!(out, "the hand did not confirm the resume")?;
        return Ok(Outcome::GivenUp);
    }
    // In its next step the hand continues, or finds another reason to stop.
    client.wait_until(LONGEST, |mode| {
        mode.stops.is_empty() == mode.stopped.is_empty()
    });
    let mode = client.mode();
    if mode.stops.is_empty() && mode.stopped.is_empty() {
        writeln!(out, "the hand has resumed")?;
        return Ok(Outcome::Done);
    }
    writeln!(
        out,
        "stop {number} was resumed; the hand remains stopped: {}",
        mode.stopped
    )?;
    write!(out, "{}", list(&mode.stops))?;
    Ok(Outcome::GivenUp)
}

/// Lists stops, one per line.
fn list(stops: &[StopInForce]) -> String {
    let line = |stop: &StopInForce| format!("  stop {}: {}\n", stop.number, stop.by);
    stops.iter().map(line).collect()
}
