//! State messages and orders of live pages.

use super::feed::Moment;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Time after which an order that had no effect is reported as failed.
const PATIENCE: Duration = Duration::from_secs(2);

/// An order from a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Stop the hand.
    Stop,
    /// Let the hand resume.
    Resume,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderMessage {
    order: Request,
}

impl Request {
    /// Parses a page's message, or returns `None` if it is invalid.
    pub fn read(message: &str) -> Option<Self> {
        let message: Option<OrderMessage> = serde_json::from_str(message).ok();
        message.map(|message| message.order)
    }
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
    /// Creates the record of an order received now.
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
        assert_eq!(Request::read(r#"{"order":"stop"}"#), Some(Request::Stop));
        assert_eq!(
            Request::read(r#"{"order":"resume"}"#),
            Some(Request::Resume)
        );
        for garbage in [
            "",
            "stop",
            "{}",
            "[]",
            r#"{"order":"go"}"#,
            r#"{"order":null}"#,
            "\0",
        ] {
            assert_eq!(Request::read(garbage), None, "{garbage}");
        }
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
