//! State messages and orders of live pages.

use super::feed::Moment;
use feeler_record::Felt;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use std::time::{Duration, Instant};

/// Time after which an order that had no effect is reported as failed.
const PATIENCE: Duration = Duration::from_secs(2);

/// An order from a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Stop the hand.
    Stop,
    /// Resume the hand.
    Resume,
}

/// A message from a page.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PageMessage {
    /// An order to the hand.
    Order(Request),
    /// Rumble and tone that the page plays from now on.
    #[serde(deserialize_with = "read_felt")]
    Felt(Felt),
}

impl PageMessage {
    /// Parses a page's message, or returns `None` if it is invalid.
    pub fn read(message: &str) -> Option<Self> {
        serde_json::from_str(message).ok()
    }
}

/// Rumble and tone as reported by the page: `LiveFelt` in `web/src/page_data.ts`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlayedFelt {
    /// Time of the row that is played, or `None` if no row has been played.
    time: Option<f64>,
    strong: f64,
    weak: f64,
    frequency: f64,
    gain: f64,
}

/// Maximum accepted frequency of a tone (Hz).
const HIGHEST: f64 = 20e3;

fn read_felt<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Felt, D::Error> {
    let played = PlayedFelt::deserialize(deserializer)?;
    let shares = [played.strong, played.weak, played.gain];
    let is_valid = shares.iter().all(|share| (0.0..=1.0).contains(share))
        && (0.0..=HIGHEST).contains(&played.frequency);
    if !is_valid {
        let expected = "expected shares of 0 to 1 and a frequency of up to 20 kHz";
        return Err(D::Error::custom(expected));
    }
    Ok(Felt {
        stamp: 0.0,
        data_stamp: played.time.unwrap_or(f64::NAN),
        rumble_strong: played.strong,
        rumble_weak: played.weak,
        tone_frequency: played.frequency,
        tone_gain: played.gain,
    })
}

#[derive(Serialize)]
struct LiveState<'a> {
    state: &'a str,
    stopped: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    answer: Option<&'static str>,
    over: bool,
}

/// The latest order and its effect.
#[derive(Debug, Clone, Copy)]
pub struct PendingOrder {
    request: Request,
    at: Instant,
    heeded: bool,
}

impl PendingOrder {
    /// Creates a record of an order received now.
    pub fn now(request: Request) -> Self {
        Self {
            request,
            at: Instant::now(),
            heeded: false,
        }
    }

    /// Describes the effect of the order, given whether the hand is `stopped`.
    pub fn answer(&mut self, stopped: bool) -> &'static str {
        let is_so = stopped == (self.request == Request::Stop);
        self.heeded |= is_so;
        match (self.request, self.heeded, self.at.elapsed() < PATIENCE) {
            (Request::Stop, true, _) => "Stop: the hand is stopped.",
            (Request::Resume, true, _) => "Resume: the hand has resumed.",
            (Request::Stop, false, true) => "Stop: order sent.",
            (Request::Resume, false, true) => "Resume: order sent.",
            (Request::Stop, false, false) => {
                "Stop: the hand has not confirmed the stop. Use the stop of the hand itself."
            }
            (Request::Resume, false, false) => "Resume: the hand stays stopped.",
        }
    }
}

/// Encodes `moment` and the effect of the latest order as a state message (JSON).
pub fn state(moment: &Moment, told: Option<&mut PendingOrder>) -> String {
    let state = LiveState {
        state: moment.words.as_str(),
        stopped: moment.stopped,
        answer: told.map(|told| told.answer(moment.stopped)),
        over: moment.over,
    };
    // Strings and booleans can always be encoded.
    serde_json::to_string(&state).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_two_orders_are_accepted() {
        let read = |order: &str| PageMessage::read(&format!(r#"{{"order":"{order}"}}"#));
        assert_eq!(read("stop"), Some(PageMessage::Order(Request::Stop)));
        assert_eq!(read("resume"), Some(PageMessage::Order(Request::Resume)));
        for garbage in [
            "",
            "stop",
            "{}",
            "[]",
            r#"{"order":"go"}"#,
            r#"{"order":null}"#,
            r#"{"order":"stop","by":"me"}"#,
            r#"{"order":"stop","felt":null}"#,
            "\0",
        ] {
            assert_eq!(PageMessage::read(garbage), None, "{garbage}");
        }
    }

    #[test]
    fn only_playable_rumble_and_tone_are_accepted() {
        let read = |[time, strong, weak, frequency, gain]: [&str; 5]| {
            PageMessage::read(&format!(
                r#"{{"felt":{{"time":{time},"strong":{strong},"weak":{weak},"frequency":{frequency},"gain":{gain}}}}}"#
            ))
        };
        let valid = ["1.5", "0", "1", "150", "0.3"];
        let felt = Felt {
            stamp: 0.0,
            data_stamp: 1.5,
            rumble_strong: 0.0,
            rumble_weak: 1.0,
            tone_frequency: 150.0,
            tone_gain: 0.3,
        };
        assert_eq!(read(valid), Some(PageMessage::Felt(felt)));
        for field in 0..valid.len() {
            for hostile in [
                "-1e-9", "1e999", "-1e999", "\"1\"", "null", "[]", "30000", "",
            ] {
                let mut hostile_fields = valid;
                hostile_fields[field] = hostile;
                let is_time = field == 0 && ["-1e-9", "null", "30000"].contains(&hostile);
                let read = read(hostile_fields);
                assert_eq!(read.is_some(), is_time, "{hostile_fields:?}: {read:?}");
            }
        }
        assert_eq!(PageMessage::read(r#"{"felt":{"strong":1}}"#), None);
    }

    #[test]
    fn an_answer_reports_the_effect_of_the_order() {
        let mut told = PendingOrder::now(Request::Resume);
        assert_eq!(told.answer(true), "Resume: order sent.");
        assert_eq!(told.answer(false), "Resume: the hand has resumed.");
        // A later stop does not change the answer.
        assert_eq!(told.answer(true), "Resume: the hand has resumed.");
    }
}
