//! Time of a hand's run, derived from the rig's stamps.
//!
//! A rig program stamps its states with its own clock, which restarts with the program. Run time follows the clock of
//! the first rig program and never decreases: the clock of a later one is offset to continue the run time.

use crate::messages::message::MessageHeader;
use crate::messages::rejection::Rejection;
use crate::messages::sequence::FORGOTTEN_AFTER;
use std::str::FromStr;

/// Maximum accepted stamp (s), three hundred years. Larger stamps lose precision in differences.
const MAX_STAMP: f64 = 1e10;

/// Maximum relative drift of the rig's clock over the hand's.
const MAX_DRIFT: f64 = 0.1;

/// Speed of a rig's time relative to real time. Parsed from text such as `1`, `0.25` or `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RigSpeed {
    /// Ratio of rig time to real time; 1 for a real rig.
    Times(f64),
    /// The rig waits for the hand's answer in every control period.
    Lockstep,
}

impl RigSpeed {
    /// Returns the ratio of rig time to real time, or 0 in lockstep, as in [`crate::messages::message::Heartbeat::speed`].
    pub fn times(self) -> f64 {
        match self {
            Self::Times(times) => times,
            Self::Lockstep => 0.0,
        }
    }
}

impl FromStr for RigSpeed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "max" {
            return Ok(Self::Lockstep);
        }
        let times = text.parse().ok().filter(|s| (0.01..=100.0).contains(s));
        let expected = || "expected 0.01 to 100, or max".into();
        times.map(Self::Times).ok_or_else(expected)
    }
}

/// Converts the rig's stamps to run time.
#[derive(Debug, Clone)]
pub struct RunClock {
    speed: RigSpeed,
    /// Control period (s, rig time).
    period: f64,
    /// Maximum jump of the rig's time (s).
    slack: f64,
    rig: Option<RigClock>,
}

/// State of the rig's clock at the latest state message.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RigClock {
    /// Instance of the program whose clock this is.
    clock: u64,
    /// Stamp of the state message (s, rig time).
    stamp: f64,
    /// Sequence number of the state message.
    sequence: u64,
    /// Offset from rig time to run time (s).
    offset: f64,
    /// Run time of the state (s).
    time: f64,
    /// Earliest possible measurement time of the state (s, on the hand's clock).
    earliest: f64,
    /// Arrival time of the state (s, on the hand's clock).
    arrived: f64,
}

impl RunClock {
    /// Creates a clock before the first state of a rig. `period` is the control period (s, rig time), and
    /// `stale_periods` the number of periods after which data is stale.
    pub fn new(speed: RigSpeed, period: f64, stale_periods: f64) -> Self {
        Self {
            speed,
            period,
            slack: (stale_periods + 1.0) * period,
            rig: None,
        }
    }

    /// Processes the stamp of a state message and returns its run time (s). The state was measured no earlier than
    /// `earliest` and received at `now` (s, on the hand's clock).
    ///
    /// # Errors
    /// Returns [`Rejection::Implausible`] if the stamp jumps or is out of range.
    pub fn take(
        &mut self,
        header: MessageHeader,
        earliest: f64,
        now: f64,
    ) -> Result<f64, Rejection> {
        let MessageHeader {
            clock,
            stamp,
            sequence,
            ..
        } = header;
        if stamp.is_nan() || stamp.abs() > MAX_STAMP {
            return Err(Rejection::Implausible);
        }
        let offset = match self.rig {
            None => (-stamp).max(0.0),
            Some(rig) if rig.clock == clock && self.can_follow(&rig, header, now) => rig.offset,
            Some(rig) if rig.clock == clock && now - rig.arrived <= FORGOTTEN_AFTER => {
                return Err(Rejection::Implausible);
            }
            // Another rig program, or one whose clock was set while it was silent.
            Some(rig) => self.now(&rig, now) - stamp,
        };
        // Rounding of large stamps must not make the run time decrease.
        let before = self.rig.map_or(0.0, |rig| rig.time);
        let time = (stamp + offset).max(before);
        self.rig = Some(RigClock {
            clock,
            stamp,
            sequence,
            offset,
            time,
            earliest,
            arrived: now,
        });
        Ok(time)
    }

    /// Returns `true` if a state with this header can follow the latest one.
    fn can_follow(&self, rig: &RigClock, header: MessageHeader, now: f64) -> bool {
        let most = match self.speed {
            RigSpeed::Times(speed) => (now - rig.earliest) * speed * (1.0 + MAX_DRIFT) + self.slack,
            RigSpeed::Lockstep => self.lockstep_time(header.sequence, rig.sequence),
        };
        (0.0..=most).contains(&(header.stamp - rig.stamp))
    }

    /// Returns the run time at `now` (s, on the hand's clock), extrapolated from the latest state.
    fn now(&self, rig: &RigClock, now: f64) -> f64 {
        let since = match self.speed {
            RigSpeed::Times(speed) => (now - rig.arrived).max(0.0) * speed,
            RigSpeed::Lockstep => self.period,
        };
        rig.time + since
    }

    /// Returns the instance of the program whose clock stamps the rig's states, or `None` before the first state.
    pub fn clock(&self) -> Option<u64> {
        self.rig.map(|rig| rig.clock)
    }

    /// Converts a stamp of the rig's clock, from message number `sequence`, to run time (s).
    ///
    /// # Errors
    /// If the stamp is from another clock, or implausibly far ahead of the latest state.
    pub fn of_rig(&self, clock: u64, stamp: f64, sequence: u64) -> Result<f64, Rejection> {
        let rig = self.rig.ok_or(Rejection::Unintroduced)?;
        if rig.clock != clock {
            return Err(Rejection::Clock);
        }
        let ahead = stamp - rig.stamp;
        let most = match self.speed {
            RigSpeed::Times(_) => self.slack,
            RigSpeed::Lockstep => self.lockstep_time(sequence, rig.sequence),
        };
        // Old data is not rejected here, because it stops the hand.
        let plausible = ahead <= most && stamp.abs() <= MAX_STAMP;
        plausible
            .then_some(stamp + rig.offset)
            .ok_or(Rejection::Implausible)
    }

    /// Converts run time to the rig's clock (s).
    pub fn to_rig(&self, time: f64) -> f64 {
        time - self.rig.map_or(0.0, |rig| rig.offset)
    }

    /// Returns the speed of the rig's time.
    pub fn speed(&self) -> RigSpeed {
        self.speed
    }

    /// Returns the maximum rig time between the states numbered `before` and `sequence` (s).
    fn lockstep_time(&self, sequence: u64, before: u64) -> f64 {
        sequence.saturating_sub(before) as f64 * self.period * (1.0 + MAX_DRIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clock with a period of 0.01 s and a maximum jump of 0.05 s.
    fn run_clock(speed: RigSpeed) -> RunClock {
        RunClock::new(speed, 0.01, 4.0)
    }

    fn header(clock: u64, sequence: u64, stamp: f64) -> MessageHeader {
        MessageHeader {
            clock,
            sequence,
            stamp,
            ..MessageHeader::default()
        }
    }

    /// Run at speed 2 whose rig 7 was at 10 s when the hand's clock was at 1 s.
    fn at_ten() -> RunClock {
        let mut clock = run_clock(RigSpeed::Times(2.0));
        assert_eq!(clock.take(header(7, 1, 10.0), 1.0, 1.001), Ok(10.0));
        clock
    }

    #[test]
    fn run_time_follows_the_first_rig() {
        let mut clock = at_ten();
        assert_eq!(clock.take(header(7, 2, 10.02), 1.01, 1.011), Ok(10.02));
        assert_eq!(clock.of_rig(7, 10.0, 2), Ok(10.0));
        assert_eq!(clock.clock(), Some(7));
    }

    #[test]
    fn run_time_is_not_negative() {
        let mut clock = run_clock(RigSpeed::Times(1.0));
        assert_eq!(clock.take(header(7, 1, -3.0), 0.0, 0.0), Ok(0.0));
        assert_eq!(clock.take(header(7, 2, -2.5), 0.5, 0.5), Ok(0.5));
        assert_eq!(clock.to_rig(0.5), -2.5);
    }

    #[test]
    fn jumps_are_rejected() {
        let mut clock = at_ten();
        for wrong in [1e300, 1e6, -1e300, f64::NAN, f64::INFINITY, 9.99, 10.11] {
            let taken = clock.take(header(7, 2, wrong), 1.01, 1.011);
            assert_eq!(taken, Err(Rejection::Implausible), "{wrong}");
        }
        assert_eq!(clock.take(header(7, 2, 10.02), 1.01, 1.011), Ok(10.02));
    }

    #[test]
    fn run_time_continues_with_another_rig() {
        let mut clock = at_ten();
        // Four seconds later, at twice real time.
        assert_eq!(clock.take(header(8, 1, 0.5), 5.0, 5.001), Ok(18.0));
        assert_eq!(clock.take(header(8, 2, 0.52), 5.01, 5.011), Ok(18.02));
        assert_eq!(clock.of_rig(7, 10.0, 2), Err(Rejection::Clock));
        assert!((clock.to_rig(18.02) - 0.52).abs() < 1e-12);
    }

    #[test]
    fn a_clock_set_during_silence_is_accepted() {
        let mut clock = at_ten();
        let taken = clock.take(header(7, 2, 3.0), 1.3, 1.3);
        assert_eq!(taken, Err(Rejection::Implausible));
        let time = clock.take(header(7, 3, 3.3), 1.601, 1.601).unwrap();
        assert!((time - 11.2).abs() < 1e-12, "{time}");
    }

    #[test]
    fn in_lockstep_each_state_advances_one_period() {
        let mut clock = run_clock(RigSpeed::Lockstep);
        assert_eq!(clock.take(header(7, 1, 0.0), 0.0, 0.0), Ok(0.0));
        // Regardless of the time until the hand's answer.
        assert_eq!(clock.take(header(7, 2, 0.01), 9.0, 9.0), Ok(0.01));
        let jump = clock.take(header(7, 3, 0.03), 9.1, 9.1);
        assert_eq!(jump, Err(Rejection::Implausible));
        assert_eq!(clock.of_rig(7, 0.02, 3), Ok(0.02));
        assert_eq!(clock.of_rig(7, 0.02, 2), Err(Rejection::Implausible));
    }
}
