//! `feeler stop` and `feeler resume`: orders to a hand from anywhere.

use super::{LinkArguments, rig_name};
use crate::options::Json;
use crate::{CommandError, Outcome};
use feeler_console::print_json;
use feeler_link::hand_client::{Ack, HandClient, INTERVAL, STEADY};
use feeler_link::message::{HandMode, StopInForce};
use feeler_link::order::{Order, stop_to_resume};
use feeler_link::right::Right;
use feeler_link::stop_wire::StopAnswer;
use feeler_rig::{LinkOptions, call_stop_door};
use serde::Serialize;
use std::io::Write;
use std::time::{Duration, Instant};

/// How long to look for a hand, and how long it may take to heed: it does so between two of its steps, which may be long.
const LONGEST: Duration = Duration::from_secs(5);

/// How long a hand is told to stop over its connections before what its stop door says counts.
const DOOR_NEXT: Duration = Duration::from_secs(1);

/// How long the hand is waited for before what its stop door says is enough.
const DOOR_FIRST: Duration = Duration::from_millis(500);

#[derive(Debug, clap::Args)]
pub struct StopArguments {
    /// Name of the rig: that of the experiment, unless its programs were given another; or the experiment's file.
    rig: String,
    /// Who says so, for the hand's screen and record.
    #[arg(long, default_value = BY)]
    from: String,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    link: LinkArguments,
}

/// What came of an order to stop; what `--json` prints.
#[derive(Default, Serialize)]
struct Stopped {
    /// Whether the hand stands still.
    stands_still: bool,
    /// Whether it waits for its rig, and will stand still when it is there.
    waits_for_rig: bool,
    /// Number of the stop, by which it is resumed; `None` if the hand gave none.
    number: Option<u64>,
    /// Why the hand stands still, in its own words.
    reason: String,
    /// All of that in a sentence.
    message: String,
}

impl Stopped {
    /// Prints it. The order was heeded if the hand stands still or will.
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
    /// Name of the rig: that of the experiment, unless its programs were given another; or the experiment's file.
    rig: String,
    /// Whose stop to resume [default: "the command line"; where there is none of that name, the hand's own]
    #[arg(long, default_value = BY, hide_default_value = true)]
    from: String,
    /// Number of the stop to resume, as `feeler stop` and `feeler resume` print it.
    #[arg(long, conflicts_with = "from")]
    number: Option<u64>,
    #[command(flatten)]
    link: LinkArguments,
}

/// Who gives an order on the command line.
const BY: &str = "the command line";

/// Tells the hand of a rig to stop, and says whether it stands still.
pub fn stop(arguments: &StopArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    told_to_stop(arguments)?.print(arguments.json, out)
}

/// Tells the hand of a rig to stop.
fn told_to_stop(arguments: &StopArguments) -> Result<Stopped, CommandError> {
    let link = LinkOptions::from(&arguments.link).with_right(&[Right::Order, Right::Stop])?;
    let rig = &rig_name(&arguments.rig)?;
    let (order, id) = Order::stop(&arguments.from);
    // Both ways at once: the door is open even where nobody can connect.
    let door = call_stop_door(&link, rig, id, &arguments.from);
    let client = HandClient::new(link.connect(rig)?)?;
    if !client.wait_until(DOOR_FIRST, |_| true) {
        let start = Instant::now();
        while !client.wait_until(INTERVAL / 4, |_| true) {
            if let Ok(answer) = door.try_recv() {
                return Ok(said_at_door(answer));
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
    let told = |message: &str| Stopped {
        message: message.to_string(),
        ..Stopped::default()
    };
    Ok(match heeded {
        // It heeds a stop when it begins.
        Ack::Stable if mode.is_waiting() => Stopped {
            waits_for_rig: true,
            number,
            message: format!(
                "the hand waits for its rig, and will stand still when it is there (stop {words})"
            ),
            ..Stopped::default()
        },
        Ack::Stable => Stopped {
            stands_still: true,
            number,
            message: format!(
                "the hand stands still: {} (stop {words}, for {STEADY:?} so far)",
                mode.stopped
            ),
            reason: mode.stopped,
            ..Stopped::default()
        },
        Ack::Reverted => told("the hand stood still, and somebody resumed it at once"),
        Ack::None => match door.recv_timeout(LONGEST) {
            Ok(answer) => said_at_door(answer),
            Err(_) => told("the hand was told to stop, but does not say that it does"),
        },
    })
}

/// What the stop door answered.
fn said_at_door(answer: StopAnswer) -> Stopped {
    let (number, reason) = (answer.order, answer.stopped);
    Stopped {
        stands_still: !reason.is_empty(),
        waits_for_rig: false,
        number: Some(number),
        message: match reason.as_str() {
            "" => format!(
                "the hand took stop {number}, which is not in force now: somebody resumed it, or the hand hangs"
            ),
            stopped => {
                format!("the hand stands still: {stopped} (stop {number}, by its stop door)")
            }
        },
        reason,
    }
}

fn unheard(rig: &str) -> CommandError {
    format!("no hand of rig {rig:?} was heard within {LONGEST:?}").into()
}

/// Resumes a stop of the hand of a rig, and says whether it goes on.
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
        writeln!(out, "no stop of the hand is in force")?;
        return Ok(Outcome::Done);
    }
    let named = |number| stops.iter().find(|stop| stop.number == number);
    let chosen = match arguments.number {
        Some(number) => named(number),
        None => stop_to_resume(&stops, &arguments.from),
    };
    let Some(stop) = chosen else {
        let listed = list(&stops);
        return Err(format!(
            "none of these stops is yours: say by --number which to resume\n{listed}"
        )
        .into());
    };
    let number = stop.number;
    let is_so = |mode: &HandMode| mode.stops.iter().all(|stop| stop.number != number);
    let order = Order::resume(&arguments.from, number);
    let heeded = client.order(&order, LONGEST, is_so)?;
    if matches!(heeded, Ack::None) {
        writeln!(
            out,
            "the hand was told to go on, but does not say that it does"
        )?;
        return Ok(Outcome::GivenUp);
    }
    // It goes on in its next step, or finds then what it must not go on for.
    client.wait_until(LONGEST, |mode| {
        mode.stops.is_empty() == mode.stopped.is_empty()
    });
    let mode = client.mode();
    if mode.stops.is_empty() && mode.stopped.is_empty() {
        writeln!(out, "the hand goes on")?;
        return Ok(Outcome::Done);
    }
    writeln!(
        out,
        "stop {number} is resumed; the hand stays stopped: {}",
        mode.stopped
    )?;
    write!(out, "{}", list(&mode.stops))?;
    Ok(Outcome::GivenUp)
}

/// A line for each of the stops.
fn list(stops: &[StopInForce]) -> String {
    let line = |stop: &StopInForce| format!("  stop {}: {}\n", stop.number, stop.by);
    stops.iter().map(line).collect()
}
