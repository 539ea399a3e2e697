//! Telling the other programs, and the user, how it goes.

use super::Program;
use crate::CommandError;
use feeler_link::inbox::Inbox;
use feeler_link::message::HandMode;
use feeler_link::outlet::send;
use feeler_link::topic::Topic;
use std::io::{self, Write, stderr};

/// Time between two modes that say the same, s: at the usual 100 Hz, every step says its own.
const MODE_INTERVAL: f64 = 0.009;

impl Program {
    /// Tells the others what the hand is about: at once what is new, else no more often than they need it.
    pub(super) fn tell_mode(&mut self, mode: &HandMode) -> Result<(), CommandError> {
        let now = (self.clock)();
        let (told, at) = &self.told;
        let about = |mode: &HandMode| (mode.phase, mode.stroke, mode.stopped.is_empty());
        if about(told) == about(mode) && now - at < MODE_INTERVAL {
            return Ok(());
        }
        send(&*self.network, Topic::Mode, mode)?;
        self.told = (mode.clone(), now);
        Ok(())
    }

    /// Says what happens as it happens.
    pub(super) fn say(&mut self, what: &str) {
        let stamp = self.control_loop.state().stamp;
        self.fault = format!("{stamp:.2} s: {what}");
        // Where nobody listens, the record says it.
        let _ = writeln!(stderr(), "{}", self.fault);
    }

    /// Tells the other programs how it goes, and the user of programs that are refused.
    pub(super) fn report(&mut self, mode: &HandMode) {
        let mismatches = self.refusals.new_ones(self.inbox.lock().peers());
        for mismatch in mismatches {
            self.say(&format!("refused: {mismatch}"));
        }
        let rival = self.other_hand();
        let had_rival = std::mem::replace(&mut self.has_rival, rival.is_some());
        if let Some(mismatch) = rival.filter(|_| !had_rival) {
            self.say(&format!("refused: {mismatch}"));
        }
        let inbox = self.inbox.lock();
        let (state, fingers) = inbox.ages((self.clock)());
        let age = fingers.fold(state, f64::max);
        let lost = inbox.fingers().iter().map(|f| f.lost).sum::<u64>() + inbox.state().lost;
        let summary = self.punctuality.summary();
        self.beacon.update(|heartbeat| {
            heartbeat.rate = 1.0 / self.period;
            heartbeat.age = age;
            heartbeat.lost = lost;
            heartbeat.refused = inbox.rejected.total();
            heartbeat.missed = summary.missed;
            heartbeat.fault = match mode.stopped.as_str() {
                "" => self.fault.clone(),
                stopped => format!("stopped: {stopped}"),
            };
        });
    }

    /// Says how it went.
    pub fn tell(&self, out: &mut dyn Write) -> io::Result<()> {
        let inbox = self.inbox.lock();
        let lost: u64 = inbox.fingers().iter().map(|f| f.lost).sum();
        let took = self.control_loop.state().stamp - self.began;
        writeln!(
            out,
            "{took:.2} s of the rig's time in {} control steps",
            self.steps
        )?;
        writeln!(out, "{}", self.punctuality.summary())?;
        writeln!(
            out,
            "{lost} tactile updates lost; refused: {}",
            inbox.rejected
        )
    }
}
