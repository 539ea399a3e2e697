//! Conversion from a run's time to ROS time.

use feeler_record::ros::Time;
use std::time::{SystemTime, UNIX_EPOCH};

/// Maximum delay (s) relative to the smallest one so far. Beyond it, the clock is assumed to run slower or to have
/// paused.
const LONGEST_BEHIND: f64 = 0.1;

/// Maximum number of clocks in a rig, one per program. If there are more, the oldest is dropped.
const MAX_CLOCKS: usize = 16;

/// Converter of a run's stamps to ROS time.
pub enum Stamps {
    /// ROS time is the run's time.
    OfTheRun,
    /// ROS time is the time of day. Contains each clock's id and the offset to add to its stamps (s).
    OfTheDay(Vec<(u64, f64)>),
}

impl Stamps {
    /// Creates a converter to the run's time if `of_the_run`, otherwise to the time of day.
    pub fn new(of_the_run: bool) -> Self {
        match of_the_run {
            true => Self::OfTheRun,
            false => Self::OfTheDay(Vec::new()),
        }
    }

    /// Converts `stamp` (s) of `clock`, received at `now` (s since 1970). The message with the shortest delay
    /// determines the clock's offset.
    pub fn of(&mut self, clock: u64, stamp: f64, now: f64) -> Option<Time> {
        let Self::OfTheDay(clocks) = self else {
            return Time::of(stamp);
        };
        let seen = now - stamp;
        let offset = match clocks.iter_mut().find(|(number, _)| *number == clock) {
            Some((_, offset)) => {
                let behind = seen - *offset;
                if !(0.0..=LONGEST_BEHIND).contains(&behind) {
                    *offset = seen;
                }
                *offset
            }
            None => {
                if clocks.len() == MAX_CLOCKS {
                    clocks.remove(0);
                }
                clocks.push((clock, seen));
                seen
            }
        };
        Time::of(stamp + offset)
    }
}

/// Returns the time of day (s since 1970).
pub fn time_of_day() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_delay_determines_the_offset() {
        let mut stamps = Stamps::new(false);
        let mut of = |clock, stamp, now| {
            let time = stamps.of(clock, stamp, now).expect("a time");
            f64::from(time.sec) + f64::from(time.nanosec) * 1e-9
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
        assert!(near(of(1, 5.0, 1005.0), 1005.0));
        assert!(near(of(1, 5.01, 1005.06), 1005.01), "late");
        assert!(near(of(1, 5.02, 1005.01), 1005.01), "quicker");
        assert!(near(of(2, 7.0, 1005.02), 1005.02), "another clock");
        assert!(near(of(1, 5.03, 1006.0), 1006.0), "held up");
        assert_eq!(Stamps::new(true).of(1, 5.0, 1005.0), Time::of(5.0));
    }
}
