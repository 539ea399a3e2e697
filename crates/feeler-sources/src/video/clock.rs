//! Stamps and sequence numbers of a camera's images: the driver's if they are plausible, otherwise derived from
//! arrivals. Independent of hardware.

use super::buffer::DriverStamp;
use std::collections::VecDeque;

/// Maximum time by which a driver's stamp may exceed the arrival, s: error of converting between the camera's and the
/// host's clock. Such a stamp is replaced by the arrival.
const AHEAD: f64 = 5e-3;
/// Maximum time from exposure until the driver receives the image's buffer, s: longest exposure and read-out.
const EXPOSURE: f64 = 1.0;
/// Upper bound of the number of buffers in a stream.
const BUFFERS: usize = 8;
/// Maximum number of images that the driver may count per interval, because the rate may be set lower than the
/// camera's.
const RATE: f64 = 4.0;
/// Number of images that the driver may count in addition.
const SPARE: f64 = 30.0;

/// Stamp and sequence number of one image.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stamped {
    /// Seconds since the camera was opened.
    pub(super) stamp: f64,
    /// Sequence number, increasing; a gap means dropped frames.
    pub(super) sequence: u64,
    /// Warning about the driver's stamp or number, the first time it is implausible.
    pub(super) warning: Option<String>,
}

/// Assigns stamps and sequence numbers to frames.
///
/// A stamp never decreases and is never later than the arrival, so no driver can make an image look newer than it
/// would without stamps.
#[derive(Debug)]
pub(super) struct FrameClock {
    /// Time of opening by the driver's clock, s.
    opened: f64,
    /// Time between frames as set by the driver, s.
    interval: f64,
    /// Last arrivals, the latest at the back, s.
    arrivals: VecDeque<f64>,
    last: Option<Last>,
    has_warned: bool,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    stamp: f64,
    sequence: u64,
    /// Sequence number of the latest frame, as the driver counts.
    counted: Option<u32>,
}

impl FrameClock {
    /// Creates a clock for frames that are `interval` seconds apart. `opened` is the time by the driver's clock (s)
    /// at which the camera was opened.
    pub(super) fn new(opened: f64, interval: f64) -> Self {
        Self {
            opened,
            interval,
            arrivals: VecDeque::with_capacity(BUFFERS),
            last: None,
            has_warned: false,
        }
    }

    /// Returns the stamp and sequence number of an image that arrived `arrival` seconds after the camera was opened.
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

    /// Returns the driver's stamp in seconds since the camera was opened, or the reason why it is implausible.
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
        // The oldest of these arrivals precedes the time at which the driver received this image's buffer.
        let handed = match self.arrivals.len() < BUFFERS {
            true => 0.0,
            false => self.arrivals.front().copied().unwrap_or_default(),
        };
        if stamp < handed - EXPOSURE {
            let age = arrival - stamp;
            return Err(format!(
                "the driver's stamp is {age:.3} s old, older than the image can be"
            ));
        }
        if let Some(last) = self.last
            && stamp <= last.stamp
        {
            return Err("the driver's stamp is not later than the last image's".into());
        }
        Ok(stamp.min(arrival))
    }

    /// Returns the number of frames since the last image, at least 1, and the reason if the driver's number was
    /// rejected.
    fn steps(&self, driver: Option<DriverStamp>, arrival: f64) -> (u64, Option<String>) {
        let elapsed = arrival - self.arrivals.back().copied().unwrap_or(arrival);
        let intervals = elapsed / self.interval;
        // The cast saturates: an interval of 0 s or NaN gives a step of one.
        let by_time = (intervals.round() as u64).clamp(1, u64::from(u32::MAX));
        let counted = self.last.and_then(|last| last.counted);
        let (Some(before), Some(driver)) = (counted, driver) else {
            return (by_time, None);
        };
        let steps = driver.sequence.wrapping_sub(before);
        // Frames dropped before this image's buffer was free are not reflected in this image's arrival.
        let since = arrival - self.arrivals.front().copied().unwrap_or(arrival);
        let most = (RATE * (since + EXPOSURE) / self.interval).max(0.0) + SPARE;
        if steps == 0 || f64::from(steps) > most {
            let number = driver.sequence;
            let fault = format!("the driver counts frame {number} after frame {before}");
            return (by_time, Some(fault));
        }
        (u64::from(steps), None)
    }

    /// Returns the warning for the first `fault`, and `None` for later ones.
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
