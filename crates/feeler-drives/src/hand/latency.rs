//! Detection of adapters that deliver responses late.

use super::DriveHand;
use crate::bus::BusError;
use crate::error::DriveError;
use crate::registers::Registers;

/// Fraction of the maximum age of joint angles by which an adapter may delay responses.
const SHARE: f64 = 0.25;
/// Timeout of a response from a slow adapter, s: several times the usual 16 ms.
const PATIENCE: f64 = 0.1;

impl DriveHand {
    /// Checks that the adapter has delivered the responses soon after they were on the bus. Angles are stamped at their
    /// arrival, so an adapter that collects bytes for 16 ms makes them older than they appear.
    pub(super) fn check_latency(&self) -> Result<(), DriveError> {
        // Each exchange is delayed.
        let exchanges = match self.config.protocol.has_sync_read() {
            true => 1,
            false => self.ids.len().max(1),
        };
        let limit = SHARE * self.most_age / exchanges as f64;
        let latency = self.bus.usual_latency();
        match latency <= limit {
            true => Ok(()),
            false => Err(DriveError::SlowAdapter { latency, limit }),
        }
    }

    /// Returns the error of a slow adapter if it caused `error`, a missing response; otherwise returns `error`.
    pub(super) fn blame_adapter(&mut self, error: DriveError) -> DriveError {
        let id = match &error {
            DriveError::Servo {
                source: BusError::NoReply { id, .. },
                ..
            } => *id,
            _ => return error,
        };
        let register = Registers::of(self.config.protocol).model;
        let timeout = self.bus.set_timeout(PATIENCE);
        self.bus.forget_latency();
        let answers = (0..3).all(|_| self.bus.read(id, register).is_ok());
        self.bus.set_timeout(timeout);
        let latency = self.bus.usual_latency();
        match answers && latency > timeout {
            true => DriveError::SlowAdapter {
                latency,
                limit: timeout,
            },
            false => error,
        }
    }
}
