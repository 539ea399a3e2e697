//! The time of a hand's run, from the stamps of whatever rig there is.
//!
//! A rig stamps its states by its own clock, which begins anew with each of its programs. The time of the run is that
//! of the first rig. It never goes back: a later rig's clock is put where the run's time has come to meanwhile.

use super::message::MessageHeader;
use super::rejection::Rejection;
use super::sequence::FORGOTTEN_AFTER;
use std::str::FromStr;

/// The latest stamp that is taken, s: three hundred years. Later ones leave no room for a difference.
const MOST_STAMP: f64 = 1e10;

/// By how much the rig's clock may be faster than the hand's.
const MOST_DRIFT: f64 = 0.1;

/// How fast the time of a rig goes. Written as in `1`, `0.25`, or `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RigSpeed {
    /// So many times as fast as real time; 1 for a real rig.
    Times(f64),
    /// As fast as the hand answers: the rig waits for it in every control period.
    Lockstep,
}

impl RigSpeed {
    /// Seconds of the rig in a second; 0 where it waits for the hand, as [`super::message::Heartbeat::speed`].
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

/// Maps the rig's stamps onto the time of the run.
#[derive(Debug, Clone)]
pub struct RunClock {
    speed: RigSpeed,
    /// The control period, s of the rig's time.
    period: f64,
    /// How much the rig's time may jump at once, s.
    slack: f64,
    rig: Option<RigClock>,
}

/// The rig's clock as of its newest state.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RigClock {
    /// The program whose clock it is, by its instance.
    clock: u64,
    /// The state's stamp, s.
    stamp: f64,
    /// Its number.
    sequence: u64,
    /// What to add for the time of the run, s.
    offset: f64,
    /// The state's time in the run, s.
    time: f64,
    /// The earliest time at which the state can have been taken, and when it came, s on the hand's clock.
    earliest: f64,
    arrived: f64,
}

impl RunClock {
    /// The clock of a run whose rig has yet to be heard, for a control period of so many seconds of the rig's time, of
    /// which `stale_periods` may pass without news.
    pub fn new(speed: RigSpeed, period: f64, stale_periods: f64) -> Self {
        Self {
            speed,
            period,
            slack: (stale_periods + 1.0) * period,
            rig: None,
        }
    }

    /// Takes the state of `header`, which was taken no earlier than `earliest` and came at `now`, s on the hand's
    /// clock; its time in the run, s.
    ///
    /// # Errors
    /// When its stamp cannot be true: it jumps.
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
        if stamp.is_nan() || stamp.abs() > MOST_STAMP {
            return Err(Rejection::Implausible);
        }
        let offset = match self.rig {
            None => (-stamp).max(0.0),
            Some(rig) if rig.clock == clock && self.can_follow(&rig, header, now) => rig.offset,
            Some(rig) if rig.clock == clock && now - rig.arrived <= FORGOTTEN_AFTER => {
                return Err(Rejection::Implausible);
            }
            // Another rig, or one that was silent and whose clock was set meanwhile.
            Some(rig) => self.now(&rig, now) - stamp,
        };
        // A clock that counts from long ago leaves few digits for a difference.
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

    /// Whether the state of `header` can be one that follows the newest.
    fn can_follow(&self, rig: &RigClock, header: MessageHeader, now: f64) -> bool {
        let most = match self.speed {
            RigSpeed::Times(speed) => {
                (now - rig.earliest) * speed * (1.0 + MOST_DRIFT) + self.slack
            }
            RigSpeed::Lockstep => self.lockstep_time(header.sequence, rig.sequence),
        };
        (0.0..=most).contains(&(header.stamp - rig.stamp))
    }

    /// The time of the run at `now`, s on the hand's clock, by how long it is since the newest state.
    fn now(&self, rig: &RigClock, now: f64) -> f64 {
        let since = match self.speed {
            RigSpeed::Times(speed) => (now - rig.arrived).max(0.0) * speed,
            RigSpeed::Lockstep => self.period,
        };
        rig.time + since
    }

    /// The program whose clock the rig's states are stamped by, by its instance; none before the first state.
    pub fn clock(&self) -> Option<u64> {
        self.rig.map(|rig| rig.clock)
    }

    /// The time in the run, s, of what the rig's own clock stamps `stamp`.
    ///
    /// # Errors
    /// When it is of another clock, or further from the newest state than data may be that are of use.
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
        // What is too old stops the hand; it needs no refusal here.
        let plausible = ahead <= most && stamp.abs() <= MOST_STAMP;
        plausible
            .then_some(stamp + rig.offset)
            .ok_or(Rejection::Implausible)
    }

    /// What the hand's `time` in the run is on the rig's own clock, s.
    pub fn to_rig(&self, time: f64) -> f64 {
        time - self.rig.map_or(0.0, |rig| rig.offset)
    }

    /// How fast the rig's time goes.
    pub fn speed(&self) -> RigSpeed {
        self.speed
    }

    /// How far the rig's time can go at most from the state of the number `before` to that of `sequence`, s.
    fn lockstep_time(&self, sequence: u64, before: u64) -> f64 {
        sequence.saturating_sub(before) as f64 * self.period * (1.0 + MOST_DRIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rig of that speed, whose time may jump by 0.05 s.
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

    /// A run at the speed 2 whose rig 7 was at 10 s when the hand's clock was at 1 s.
    fn at_ten() -> RunClock {
        let mut clock = run_clock(RigSpeed::Times(2.0));
        assert_eq!(clock.take(header(7, 1, 10.0), 1.0, 1.001), Ok(10.0));
        clock
    }

    #[test]
    fn the_first_rigs_time_is_that_of_the_run() {
        let mut clock = at_ten();
        assert_eq!(clock.take(header(7, 2, 10.02), 1.01, 1.011), Ok(10.02));
        assert_eq!(clock.of_rig(7, 10.0, 2), Ok(10.0));
        assert_eq!(clock.clock(), Some(7));
    }

    #[test]
    fn no_time_of_a_run_is_negative() {
        let mut clock = run_clock(RigSpeed::Times(1.0));
        assert_eq!(clock.take(header(7, 1, -3.0), 0.0, 0.0), Ok(0.0));
        assert_eq!(clock.take(header(7, 2, -2.5), 0.5, 0.5), Ok(0.5));
        assert_eq!(clock.to_rig(0.5), -2.5);
    }

    #[test]
    fn a_clock_that_jumps_is_refused_and_the_true_one_taken() {
        let mut clock = at_ten();
        for wrong in [1e300, 1e6, -1e300, f64::NAN, f64::INFINITY, 9.99, 10.11] {
            let taken = clock.take(header(7, 2, wrong), 1.01, 1.011);
            assert_eq!(taken, Err(Rejection::Implausible), "{wrong}");
        }
        assert_eq!(clock.take(header(7, 2, 10.02), 1.01, 1.011), Ok(10.02));
    }

    #[test]
    fn another_rigs_time_goes_on_from_that_of_the_run() {
        let mut clock = at_ten();
        // Four seconds later, at twice real time.
        assert_eq!(clock.take(header(8, 1, 0.5), 5.0, 5.001), Ok(18.0));
        assert_eq!(clock.take(header(8, 2, 0.52), 5.01, 5.011), Ok(18.02));
        assert_eq!(clock.of_rig(7, 10.0, 2), Err(Rejection::Clock));
        assert!((clock.to_rig(18.02) - 0.52).abs() < 1e-12);
    }

    #[test]
    fn a_clock_that_was_set_is_taken_when_it_was_silent() {
        let mut clock = at_ten();
        let taken = clock.take(header(7, 2, 3.0), 1.3, 1.3);
        assert_eq!(taken, Err(Rejection::Implausible));
        let time = clock.take(header(7, 3, 3.3), 1.601, 1.601).unwrap();
        assert!((time - 11.2).abs() < 1e-12, "{time}");
    }

    #[test]
    fn in_lockstep_a_state_is_a_period() {
        let mut clock = run_clock(RigSpeed::Lockstep);
        assert_eq!(clock.take(header(7, 1, 0.0), 0.0, 0.0), Ok(0.0));
        // However long the hand took for its answer.
        assert_eq!(clock.take(header(7, 2, 0.01), 9.0, 9.0), Ok(0.01));
        let jump = clock.take(header(7, 3, 0.03), 9.1, 9.1);
        assert_eq!(jump, Err(Rejection::Implausible));
        assert_eq!(clock.of_rig(7, 0.02, 3), Ok(0.02));
        assert_eq!(clock.of_rig(7, 0.02, 2), Err(Rejection::Implausible));
    }
}
