//! Times of a run as those of the graph.

use feeler_record::ros::Time;
use std::time::{SystemTime, UNIX_EPOCH};

/// A run whose time is further behind that of day than ever before by this, s, goes slower, or was held up.
const LONGEST_BEHIND: f64 = 0.1;

/// Most clocks of a rig: one of each program. Of more, the oldest is forgotten.
const MOST_CLOCKS: usize = 16;

/// Makes stamps of the graph from those of a run.
pub enum Stamps {
    /// They are the run's.
    OfTheRun,
    /// They are of the time of day. Of each clock, by its number: what is to be added to its stamps, s.
    OfTheDay(Vec<(u64, f64)>),
}

impl Stamps {
    /// The run's own, or those of the time of day.
    pub fn new(of_the_run: bool) -> Self {
        match of_the_run {
            true => Self::OfTheRun,
            false => Self::OfTheDay(Vec::new()),
        }
    }

    /// The stamp of something that a `clock` says is of `stamp`, s, and that arrived at `now`, s since 1970. That which took least
    /// time to arrive tells how the clock goes.
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
                if clocks.len() == MOST_CLOCKS {
                    clocks.remove(0);
                }
                clocks.push((clock, seen));
                seen
            }
        };
        Time::of(stamp + offset)
    }
}

/// The time of day, s since 1970.
pub fn time_of_day() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_came_quickest_tells_how_the_clock_goes() {
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
