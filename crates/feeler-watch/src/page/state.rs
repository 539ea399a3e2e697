//! What a page is told in words.

use super::feed::Moment;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// A hand that does not do what it was told within this time is said not to.
const PATIENCE: Duration = Duration::from_secs(2);

/// What a page may ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Stop the hand.
    Stop,
    /// Let it go on.
    Resume,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderMessage {
    order: Request,
}

impl Request {
    /// What a message of a page asks for; nothing where it makes no sense.
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

/// The last request, and what came of it.
#[derive(Debug, Clone, Copy)]
pub struct Told {
    request: Request,
    at: Instant,
    heeded: bool,
}

impl Told {
    /// That somebody asked now.
    pub fn now(request: Request) -> Self {
        Self {
            request,
            at: Instant::now(),
            heeded: false,
        }
    }

    /// What came of it, where the hand is `stopped` or not.
    pub fn answer(&mut self, stopped: bool) -> &'static str {
        let is_so = stopped == (self.request == Request::Stop);
        self.heeded |= is_so;
        match (self.request, self.heeded, self.at.elapsed() < PATIENCE) {
            (Request::Stop, true, _) => "Stop: the hand stands still.",
            (Request::Resume, true, _) => "Resume: the hand goes on.",
            (Request::Stop, false, true) => "Stop: the hand was told.",
            (Request::Resume, false, true) => "Resume: the hand was told.",
            (Request::Stop, false, false) => {
                "Stop: the hand does not say that it stands still. Use its own stop."
            }
            (Request::Resume, false, false) => "Resume: the hand stays stopped.",
        }
    }
}

/// What a page is told of `moment`, and what came of the last request.
pub fn state(moment: &Moment, told: Option<&mut Told>) -> String {
    let state = LiveState {
        state: moment.words.as_str(),
        stopped: moment.stopped,
        answer: told.map(|told| told.answer(moment.stopped)),
        over: moment.over,
    };
    // Text, truths and nothing else can always be written.
    serde_json::to_string(&state).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_two_orders_are_orders() {
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
    fn an_answer_says_what_came_of_it() {
        let mut told = Told::now(Request::Resume);
        assert_eq!(told.answer(true), "Resume: the hand was told.");
        assert_eq!(told.answer(false), "Resume: the hand goes on.");
        // That somebody stops it again later is another matter.
        assert_eq!(told.answer(true), "Resume: the hand goes on.");
    }
}
