//! How old data of a graph may be. Their stamps are of the time of day, or of a simulation's clock: who sends and who reads must agree on
//! it, so computers need synchronised clocks (unlike on feeler's own link). Besides, nothing may have arrived longer ago than it may be
//! old: that needs no clock of anybody else.

use crate::message::Clock;
use crate::node::{Node, NodeError, Subscription, wall_clock_ns};
use crate::qos::Qos;
use feeler_record::ros::Time;
use feeler_record::wire::cdr;
use std::fmt::Display;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Why data are not to be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StaleError {
    /// None came.
    #[error("{0}: nothing was heard yet")]
    Nothing(String),
    /// They are too old.
    #[error(
        "{topic}: data of at most {most:.3} s expected, by their stamp they are {age:.3} s old; for {silent:.3} s none came"
    )]
    Old {
        /// The topic.
        topic: String,
        /// How old they are, s.
        age: f64,
        /// For how long none came, s: all of the age when nobody sends, little of it when data are late.
        silent: f64,
        /// How old they may be, s.
        most: f64,
    },
    /// They are of the future: clocks differ.
    #[error(
        "{topic}: data are stamped {ahead:.3} s ahead of the clock here: synchronise the clocks, or set use_sim_time on both sides"
    )]
    Ahead {
        /// The topic.
        topic: String,
        /// How far they are ahead, s.
        ahead: f64,
    },
    /// None came for too long.
    #[error("{topic}: data every {most:.3} s expected, for {silent:.3} s none came")]
    Silent {
        /// The topic.
        topic: String,
        /// For how long none came, s.
        silent: f64,
        /// How long that may be, s.
        most: f64,
    },
    /// A simulation's clock was not heard.
    #[error("/clock was not heard yet")]
    NoClock,
}

/// What time it is in a graph. All copies of a simulated one are the same clock.
#[derive(Clone)]
pub enum GraphClock {
    /// The time of day.
    TimeOfDay,
    /// That of a simulation, for as long as this is kept.
    Simulated(Arc<SimulatedClock>),
}

/// The time that `/clock` tells.
pub struct SimulatedClock {
    /// The newest, s.
    now: Arc<Mutex<Option<f64>>>,
    _subscription: Subscription,
}

impl GraphClock {
    /// The time that `/clock` tells to `node`.
    ///
    /// # Errors
    /// When the node's session is closed.
    pub fn simulated(node: &mut Node) -> Result<Self, NodeError> {
        let now = Arc::new(Mutex::new(None));
        let newest = Arc::clone(&now);
        let subscription =
            node.subscribe::<Clock>("/clock", Qos::SENSOR_DATA, move |bytes, _| {
                if let Ok(Clock { clock }) = cdr::decode(bytes) {
                    *lock(&newest) = Some(seconds(clock));
                }
            })?;
        Ok(Self::Simulated(Arc::new(SimulatedClock {
            now,
            _subscription: subscription,
        })))
    }

    /// The time, s: since 1970, or as the simulation has it.
    ///
    /// # Errors
    /// When no `/clock` was heard yet.
    pub fn now(&self) -> Result<f64, StaleError> {
        match self {
            Self::TimeOfDay => Ok(wall_clock_ns() as f64 * 1e-9),
            Self::Simulated(clock) => lock(&clock.now).ok_or(StaleError::NoClock),
        }
    }
}

/// How old the data of a topic may be.
pub struct Freshness {
    /// The topic, for messages.
    pub topic: String,
    /// What time it is.
    pub clock: GraphClock,
    /// How old they may be, s of the graph's time.
    pub most: f64,
    /// Seconds of the graph's time in a second: 1 unless it is a simulation's.
    pub speed: f64,
}

impl Freshness {
    /// How old, s of the graph's time, data of `stamp`, s, are that arrived at `arrived`: by stamp or by arrival, whichever is more. Refused if
    /// there are none yet, they are of no use because of `error`, or they are too old. Allocates where it refuses.
    ///
    /// # Errors
    /// Why, in words.
    pub fn check(
        &self,
        stamp: f64,
        arrived: Option<Instant>,
        error: Option<&impl Display>,
    ) -> Result<f64, String> {
        let arrived = arrived.ok_or_else(|| StaleError::Nothing(self.topic.clone()).to_string())?;
        if let Some(error) = error {
            return Err(format!("{}: {error}", self.topic));
        }
        let now = self.clock.now().map_err(|e| e.to_string())?;
        let fresh = self.check_at(now, stamp, arrived.elapsed());
        fresh.map_err(|e| e.to_string())
    }

    /// Whether data of `stamp`, s, are news after those of `newest` that arrived at `arrived`. A stamp that does not rise is of a message that
    /// was overtaken; after a silence, it is of a sender who was started or whose clock was set anew.
    pub(crate) fn is_news(&self, stamp: f64, newest: f64, arrived: Option<Instant>) -> bool {
        let silent = arrived.is_none_or(|arrived| self.is_silent(arrived.elapsed()));
        silent || stamp > newest
    }

    /// Whether it is too long `since` something arrived.
    fn is_silent(&self, since: Duration) -> bool {
        since.as_secs_f64() * self.speed > self.most
    }

    fn check_at(&self, now: f64, stamp: f64, since: Duration) -> Result<f64, StaleError> {
        let (age, most) = (now - stamp, self.most);
        let silent = since.as_secs_f64() * self.speed;
        let topic = || self.topic.clone();
        if self.is_silent(since) {
            return Err(StaleError::Silent {
                topic: topic(),
                silent,
                most,
            });
        }
        if age < -most {
            return Err(StaleError::Ahead {
                topic: topic(),
                ahead: -age,
            });
        }
        // What is no number is not fresh.
        match age <= most {
            true => Ok(age.max(silent)),
            false => Err(StaleError::Old {
                topic: topic(),
                age,
                silent,
                most,
            }),
        }
    }
}

/// A stamp, s.
pub(crate) fn seconds(time: Time) -> f64 {
    f64::from(time.sec) + f64::from(time.nanosec) * 1e-9
}

/// A panic in one thread does not lock the others out.
pub(crate) fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_and_arrivals_are_both_judged() {
        let freshness = Freshness {
            topic: "/joint_states".into(),
            clock: GraphClock::TimeOfDay,
            most: 0.1,
            speed: 0.5,
        };
        let check =
            |stamp, since| freshness.check_at(1000.0, stamp, Duration::from_secs_f64(since));
        let near = |age: Result<f64, StaleError>, expected: f64| {
            assert!((age.expect("fresh") - expected).abs() < 1e-9);
        };
        near(check(999.95, 0.05), 0.05);
        near(check(1000.05, 0.15), 0.075);
        assert!(matches!(check(999.8, 0.05), Err(StaleError::Old { .. })));
        assert!(matches!(check(1000.2, 0.05), Err(StaleError::Ahead { .. })));
        assert!(matches!(
            check(999.95, 0.21),
            Err(StaleError::Silent { .. })
        ));
        assert!(check(f64::NAN, 0.0).is_err());
    }

    #[test]
    fn who_was_silent_may_begin_anew() {
        let freshness = Freshness {
            topic: "/joint_states".into(),
            clock: GraphClock::TimeOfDay,
            most: 60.0,
            speed: 1.0,
        };
        let now = Instant::now();
        assert!(freshness.is_news(5.0, f64::NAN, None));
        assert!(freshness.is_news(5.1, 5.0, Some(now)));
        assert!(!freshness.is_news(5.0, 5.0, Some(now)));
        let long_ago = now
            .checked_sub(Duration::from_secs(61))
            .expect("it runs for longer");
        assert!(freshness.is_news(0.0, 5.0, Some(long_ago)));
    }
}
