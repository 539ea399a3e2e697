//! Age limits for data from a ROS 2 graph.
//!
//! Stamps are in wall-clock time or in a simulation's time. Unlike on feeler's own link, the clocks of sender and
//! receiver must be synchronised. The time since the last message arrived is limited as well; it depends only on the
//! receiver's clock.

use crate::message::Clock;
use crate::node::{Node, Subscription};
use crate::node_error::NodeError;
use crate::qos::Qos;
use crate::wall_clock::wall_clock_ns;
use feeler_record::ros::Time;
use feeler_record::wire::cdr;
use std::fmt::Display;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Error for data that are missing or too old.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StaleError {
    /// No message has arrived yet.
    #[error("{0}: no message received yet")]
    Nothing(String),
    /// The stamp is too old.
    #[error(
        "{topic}: data are {age:.3} s old by their stamp, expected at most {most:.3} s; no message for {silent:.3} s"
    )]
    Old {
        /// Name of the topic.
        topic: String,
        /// Age of the data by their stamp (s).
        age: f64,
        /// Time since the last message arrived (s): about `age` if the sender is silent, much less if messages are
        /// delayed.
        silent: f64,
        /// Maximum age (s).
        most: f64,
    },
    /// The stamp is in the future, because the clocks are not synchronised.
    #[error(
        "{topic}: data are stamped {ahead:.3} s ahead of the clock of this node; synchronise the clocks, or set use_sim_time on both sides"
    )]
    Ahead {
        /// Name of the topic.
        topic: String,
        /// Stamp minus the current time of the graph's clock (s).
        ahead: f64,
    },
    /// No message has arrived for too long.
    #[error(
        "{topic}: data are missing: no message for {silent:.3} s, expected one every {most:.3} s"
    )]
    Silent {
        /// Name of the topic.
        topic: String,
        /// Time since the last message arrived (s).
        silent: f64,
        /// Maximum time between messages (s).
        most: f64,
    },
    /// The clock is simulated, and no message on `/clock` has arrived yet.
    #[error("no message on /clock received yet")]
    NoClock,
}

/// Clock of the stamps in a ROS 2 graph. Clones share the subscription of a simulated clock.
#[derive(Clone)]
pub enum GraphClock {
    /// Wall clock of this computer.
    TimeOfDay,
    /// Clock of a simulation, subscribed to `/clock` until the last clone is dropped.
    Simulated(Arc<SimulatedClock>),
}

/// Time that a simulation publishes on `/clock`.
pub struct SimulatedClock {
    /// Latest time (s), or `None` before the first message.
    now: Arc<Mutex<Option<f64>>>,
    _subscription: Subscription,
}

impl GraphClock {
    /// Creates a simulated clock from a subscription of `node` to `/clock`.
    ///
    /// # Errors
    /// If the node's session is closed.
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

    /// Returns the current time (s): since 1970, or of the simulation.
    ///
    /// # Errors
    /// If the clock is simulated and no message on `/clock` has arrived yet.
    pub fn now(&self) -> Result<f64, StaleError> {
        match self {
            Self::TimeOfDay => Ok(wall_clock_ns() as f64 * 1e-9),
            Self::Simulated(clock) => lock(&clock.now).ok_or(StaleError::NoClock),
        }
    }
}

/// Age limit for the data of a topic.
pub struct Freshness {
    /// Name of the topic, for error messages.
    pub topic: String,
    /// Clock of the stamps.
    pub clock: GraphClock,
    /// Maximum age (s, by `clock`).
    pub most: f64,
    /// Speed of `clock` relative to real time; 1 unless simulated.
    pub speed: f64,
}

impl Freshness {
    /// Returns the age (s, by `clock`) of data with `stamp` (s) that arrived at `arrived`: the larger of the ages by
    /// stamp and by arrival. Allocates only if it returns an error.
    ///
    /// # Errors
    /// If no data have arrived yet, `error` is given, the data are too old, or their stamp is in the future.
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

    /// Returns `true` if data with `stamp` (s) supersede the latest, which have the stamp `newest` (s) and arrived at
    /// `arrived`. Data whose stamp is not newer arrived out of order. They are accepted only after a time without data,
    /// because the sender may have restarted or its clock may have been set.
    pub(crate) fn is_news(&self, stamp: f64, newest: f64, arrived: Option<Instant>) -> bool {
        let silent = arrived.is_none_or(|arrived| self.is_silent(arrived.elapsed()));
        silent || stamp > newest
    }

    /// Returns `true` if the real time `since` the last arrival is too long.
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
        // A NaN age counts as too old.
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

/// Converts a stamp to seconds.
pub(crate) fn seconds(time: Time) -> f64 {
    f64::from(time.sec) + f64::from(time.nanosec) * 1e-9
}

/// Locks a mutex, even if another thread panicked while holding it.
pub(crate) fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn age_is_limited_by_stamp_and_by_arrival() {
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
    fn stamps_may_restart_after_a_silence() {
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
            .expect("an instant 61 s ago");
        assert!(freshness.is_news(0.0, 5.0, Some(long_ago)));
    }
}
