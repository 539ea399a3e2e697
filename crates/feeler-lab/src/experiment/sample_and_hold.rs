//! Simulated sensors with a lower frame rate than the control loop.

use crate::experiment::Sensor;
use feeler::control::{TactileReading, TactileSource};
use feeler::sensor::forces::SensorError;
use feeler::sensor::image::Frame;
use feeler_sim::rig::SimRig;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Tolerance of a frame's time, relative to the frame period: steps of the world do not coincide with it exactly.
const EARLY: f64 = 1e-6;

/// Times at which new frames are taken, in the rig's time.
#[derive(Debug, Clone)]
pub(super) struct FrameTimes {
    /// Period (s).
    period: f64,
    due: f64,
}

impl FrameTimes {
    /// Schedules a frame every `period` seconds, starting at time 0.
    pub(super) fn new(period: f64) -> Self {
        Self { period, due: 0.0 }
    }

    /// Returns `true` if a new frame is due at time `now` (s), and schedules the next one.
    pub(super) fn is_due(&mut self, now: f64) -> bool {
        if now < self.due - EARLY * self.period {
            return false;
        }
        // Schedule the next multiple of the period, so that a late frame does not delay the following ones.
        self.due = ((now / self.period + EARLY).floor() + 1.0) * self.period;
        true
    }
}

/// A simulated sensor that holds its last reading until the next frame is due, in the rig's time.
pub(super) struct SampleAndHold {
    sensor: Sensor,
    rig: SimRig,
    frames: FrameTimes,
    taken: FrameCounter,
}

/// Number of frames that a sensor has taken.
pub(super) type FrameCounter = Arc<AtomicU64>;

impl SampleAndHold {
    /// Creates a source that samples `sensor` of `rig` every `period` seconds and counts its frames in `taken`.
    pub(super) fn new(sensor: Sensor, rig: SimRig, period: f64, taken: FrameCounter) -> Self {
        Self {
            taken,
            sensor,
            rig,
            frames: FrameTimes::new(period),
        }
    }
}

impl TactileSource for SampleAndHold {
    fn element_count(&self) -> usize {
        self.sensor.element_count()
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        let now = self.rig.world().state().time;
        match self.frames.is_due(now) {
            true => {
                self.taken.fetch_add(1, Ordering::Relaxed);
                self.sensor.touch(touch)
            }
            false => Ok(()),
        }
    }

    fn frame(&self) -> Option<&Frame> {
        self.sensor.frame()
    }
}

#[cfg(test)]
mod tests {
    use super::FrameTimes;

    #[test]
    fn frames_are_periodic_after_a_late_frame() {
        let mut frames = FrameTimes::new(0.01);
        let times = [
            0.0,
            0.002,
            0.0099,
            0.00999999999,
            0.013,
            0.027,
            0.029,
            0.03,
            0.04,
        ];
        let due = times.map(|now| frames.is_due(now));
        assert_eq!(
            due,
            [true, false, false, true, false, true, false, true, true]
        );
    }
}
