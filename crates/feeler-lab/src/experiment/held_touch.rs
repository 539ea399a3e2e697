//! Sensors that are slower than the control loop.

use super::Sensor;
use feeler::control::touch::{FingerTouch, TouchSource};
use feeler::sensor::frame::Frame;
use feeler::sensor::reading::SensorError;
use feeler_sim::rig::SimRig;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Part of a frame's period by which it may come early: steps of the world do not meet it exactly.
const EARLY: f64 = 1e-6;

/// When there is a new picture, in the rig's time.
#[derive(Debug, Clone)]
pub(super) struct FrameTimes {
    /// s
    period: f64,
    due: f64,
}

impl FrameTimes {
    /// A picture every `period`, s, from time 0 on.
    pub(super) fn new(period: f64) -> Self {
        Self { period, due: 0.0 }
    }

    /// Whether there is a new one at `now`, s.
    pub(super) fn is_due(&mut self, now: f64) -> bool {
        if now < self.due - EARLY * self.period {
            return false;
        }
        // The next multiple of the period: a late one puts none of the following off.
        self.due = ((now / self.period + EARLY).floor() + 1.0) * self.period;
        true
    }
}

/// A simulated sensor that delivers something new only once in a while, in the rig's time.
pub(super) struct HeldTouch {
    sensor: Sensor,
    rig: SimRig,
    frames: FrameTimes,
    taken: FramesTaken,
}

/// How many frames a sensor has taken.
pub(super) type FramesTaken = Arc<AtomicU64>;

impl HeldTouch {
    /// What `sensor` of `rig` says, once every `period`, s; counted by `taken`.
    pub(super) fn new(sensor: Sensor, rig: SimRig, period: f64, taken: FramesTaken) -> Self {
        Self {
            taken,
            sensor,
            rig,
            frames: FrameTimes::new(period),
        }
    }
}

impl TouchSource for HeldTouch {
    fn element_count(&self) -> usize {
        self.sensor.element_count()
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
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
    fn frames_come_once_a_period_and_a_late_one_delays_no_other() {
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
