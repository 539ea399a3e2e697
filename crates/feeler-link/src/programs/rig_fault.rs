//! Handling of drive failures: the rig stops its drives and orders the hand to stop until the stop is resumed.

use super::error::ProgramError;
use super::rig::RigProgram;
use super::rig_config::Rig;
use crate::hand::own_stop::RigStop;
use crate::hand::run_clock::RigSpeed;
use crate::transport::outlet::send;
use crate::transport::topic::Topic;
use feeler::hand::HandError;

/// Interval for repeating the same stop order (s), because the network may drop messages.
const AGAIN: f64 = 0.2;

impl<R: Rig> RigProgram<R> {
    /// Publishes the rig's data, or only the stop order while its drives have failed. Restarts the drives once that
    /// stop has been resumed.
    pub(super) fn publish_or_fail(&mut self) -> Result<(), ProgramError> {
        let is_resumed = match &self.node.inbox.lock().own_stop {
            Some(own) => own.is_resumed(),
            None => false,
        };
        if is_resumed {
            self.node.inbox.lock().own_stop = None;
            let restarted = self.rig.restart();
            if restarted.is_ok() {
                self.warning.clear();
                self.node.warn("resumed: the drives are ready again");
            }
            self.survive(restarted)?;
        }
        if self.node.inbox.lock().own_stop.is_some() {
            self.report_by_heartbeat();
            return self.order_stop();
        }
        match self.publish() {
            Err(ProgramError::Hand(error)) => self.survive(Err(error)),
            published => published,
        }
    }

    /// Converts a drive error to a stop of the hand, if the program is configured to survive faults.
    pub(super) fn survive(&mut self, result: Result<(), HandError>) -> Result<(), ProgramError> {
        let Err(error) = result else {
            return Ok(());
        };
        if !self.config.survives_faults || self.config.speed == RigSpeed::Lockstep {
            return Err(error.into());
        }
        if self.node.inbox.lock().own_stop.is_some() {
            // A repeated failure, for which the hand is already stopped.
            return Ok(());
        }
        self.faults = (self.faults.0 + 1, f64::NEG_INFINITY);
        self.warning = error.to_string();
        self.node.inbox.lock().own_stop = Some(RigStop::new(&self.warning));
        self.node.warn(&format!(
            "{error}; the drives stay stopped until the stop is resumed"
        ));
        self.order_stop()
    }

    /// Sends the stop order repeatedly until the hand reports the stop as active.
    fn order_stop(&mut self) -> Result<(), ProgramError> {
        let now = self.node.now();
        let order = match &self.node.inbox.lock().own_stop {
            Some(own) => own.order(),
            None => None,
        };
        if let Some(order) = order.filter(|_| now - self.faults.1 >= AGAIN) {
            self.faults.1 = now;
            send(&*self.node.network, Topic::Stop, &order)?;
        }
        Ok(())
    }
}
