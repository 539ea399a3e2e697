//! Stamps and sequence numbers of a camera's pictures: the driver's as long as they can be true, else those of arrival. No device is needed
//! for it.

use super::buffer::DriverStamp;
use std::collections::VecDeque;

/// A driver's stamp may be so much later than the arrival, s: what conversion between a camera's clock and the host's may miss. It then
/// counts as the arrival.
const AHEAD: f64 = 5e-3;
/// A picture may be so much older than the time at which its buffer was handed to the driver, s: longest exposure and read-out.
const EXPOSURE: f64 = 1.0;
/// Buffers that wait for the driver or the program at most; more than any stream here has.
const BUFFERS: usize = 8;
/// Pictures that a driver may count in one interval, for rates that are set lower than the camera's.
const RATE: f64 = 4.0;
/// Pictures that it may count besides.
const SPARE: f64 = 30.0;

/// Stamp and number of one picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stamped {
    /// Seconds since the camera was opened.
    pub(super) stamp: f64,
    /// Grows; a gap is a dropped frame.
    pub(super) sequence: u64,
    /// What is wrong with the driver's stamp or number, where that is new.
    pub(super) warning: Option<String>,
}

/// Stamps and numbers frames.
///
/// A stamp never goes back and is never later than the arrival, so that no driver makes a picture look newer than one without stamps would.
#[derive(Debug)]
pub(super) struct FrameClock {
    /// When the camera was opened, by the driver's clock, s.
    opened: f64,
    /// Time between frames as the driver has set it, s.
    interval: f64,
    /// The last arrivals, the newest at the back, s.
    arrivals: VecDeque<f64>,
    last: Option<Last>,
    has_warned: bool,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    stamp: f64,
    sequence: u64,
    /// The driver's number.
    counted: Option<u32>,
}

impl FrameClock {
    /// Stamps frames that are `interval` seconds apart, of a camera that was opened at `opened` by the driver's clock (s).
    pub(super) fn new(opened: f64, interval: f64) -> Self {
        Self {
            opened,
            interval,
            arrivals: VecDeque::with_capacity(BUFFERS),
            last: None,
            has_warned: false,
        }
    }

    /// Stamp and number of a picture that came in `arrival` seconds after the camera was opened.
    pub(super) fn stamp(&mut self, driver: Option<DriverStamp>, arrival: f64) -> Stamped {
        let (stamp, late) = match self.time(driver, arrival) {
            Ok(stamp) => (stamp, None),
            Err(fault) => (arrival, Some(fault)),
        };
        let stamp = self.last.map_or(stamp, |last| stamp.max(last.stamp));
        let (steps, gap) = self.steps(driver, arrival);
        let sequence = self
            .last
            .map_or(0, |last| last.sequence.saturating_add(steps));
        let fault = match (late, gap) {
            (Some(late), Some(gap)) => Some(format!("{late}, and {gap}")),
            (late, gap) => late.or(gap),
        };
        self.last = Some(Last {
            stamp,
            sequence,
            counted: driver.map(|driver| driver.sequence),
        });
        if self.arrivals.len() == BUFFERS {
            self.arrivals.pop_front();
        }
        self.arrivals.push_back(arrival);
        Stamped {
            stamp,
            sequence,
            warning: self.warning(fault, sequence),
        }
    }

    /// The driver's stamp, s since the camera was opened; why it cannot be true.
    fn time(&self, driver: Option<DriverStamp>, arrival: f64) -> Result<f64, String> {
        let driver = driver.ok_or("the driver returns no stamps")?;
        let time = driver
            .time
            .ok_or("the driver's stamps are not of the monotonic clock")?;
        let stamp = time - self.opened;
        if stamp > arrival + AHEAD {
            let ahead = stamp - arrival;
            return Err(format!("the driver's stamp is {ahead:.3} s in the future"));
        }
        // The oldest of these arrivals came before the driver got this picture's buffer.
        let handed = match self.arrivals.len() < BUFFERS {
            true => 0.0,
            false => self.arrivals.front().copied().unwrap_or_default(),
        };
        if stamp < handed - EXPOSURE {
            let age = arrival - stamp;
            return Err(format!(
                "the driver's stamp is {age:.3} s old, older than the picture can be"
            ));
        }
        if let Some(last) = self.last
            && stamp <= last.stamp
        {
            return Err("the driver's stamp is not later than the last picture's".into());
        }
        Ok(stamp.min(arrival))
    }

    /// Frames since the last picture, at least 1; why the driver's number was not used, if it has any.
    fn steps(&self, driver: Option<DriverStamp>, arrival: f64) -> (u64, Option<String>) {
        let elapsed = arrival - self.arrivals.back().copied().unwrap_or(arrival);
        let intervals = elapsed / self.interval;
        // A cast saturates: an interval of 0 s or none at all gives the next number.
        let by_time = (intervals.round() as u64).clamp(1, u64::from(u32::MAX));
        let counted = self.last.and_then(|last| last.counted);
        let (Some(before), Some(driver)) = (counted, driver) else {
            return (by_time, None);
        };
        let steps = driver.sequence.wrapping_sub(before);
        // Before this picture's buffer was free, frames were dropped that this picture's arrival is no measure of.
        let since = arrival - self.arrivals.front().copied().unwrap_or(arrival);
        let most = (RATE * (since + EXPOSURE) / self.interval).max(0.0) + SPARE;
        if steps == 0 || f64::from(steps) > most {
            let number = driver.sequence;
            let fault = format!("the driver counts frame {number} after frame {before}");
            return (by_time, Some(fault));
        }
        (u64::from(steps), None)
    }

    /// Warns of the first `fault`.
    fn warning(&mut self, fault: Option<String>, sequence: u64) -> Option<String> {
        let fault = fault.filter(|_| !self.has_warned)?;
        self.has_warned = true;
        Some(format!(
            "frame {sequence}: {fault}; such frames are stamped or numbered by their arrival"
        ))
    }
}

#[cfg(test)]
#[path = "clock/tests.rs"]
mod tests;
