//! A rig whose drives fail: it stands still, stops the hand and says why, until somebody has resumed that stop.

use super::error::ProgramError;
use super::rig::RigProgram;
use super::rig_config::Rig;
use crate::outlet::send;
use crate::own_stop::OwnStop;
use crate::run_clock::RigSpeed;
use crate::topic::Topic;
use feeler::hand::HandError;

/// Time between two times that the same stop is ordered, s: the network may drop what it cannot take.
const AGAIN: f64 = 0.2;

impl<R: Rig> RigProgram<R> {
    /// Publishes what the rig reads; where its drives fail, nothing but that. Restarts drives that failed when that was resumed.
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

    /// Goes on after an error of the drives, which stops the hand, where the program is to survive that.
    pub(super) fn survive(&mut self, result: Result<(), HandError>) -> Result<(), ProgramError> {
        let Err(error) = result else {
            return Ok(());
        };
        if !self.config.survives_faults || self.config.speed == RigSpeed::Lockstep {
            return Err(error.into());
        }
        if self.node.inbox.lock().own_stop.is_some() {
            // What fails goes on failing.
            return Ok(());
        }
        self.faults = (self.faults.0 + 1, f64::NEG_INFINITY);
        self.warning = error.to_string();
        self.node.inbox.lock().own_stop = Some(OwnStop::new(&self.warning));
        self.node
            .warn(&format!("{error}; stands still until that is resumed"));
        self.order_stop()
    }

    /// Orders the stop until the hand has it in force.
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
