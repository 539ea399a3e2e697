//! Reasons and counters of rejected messages.

use std::fmt;

/// Reason for rejecting a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Rejection {
    /// Longer than the topic allows.
    #[error("too long")]
    Oversized,
    /// Not a valid encoding of the message type.
    #[error("malformed")]
    Malformed,
    /// Of another protocol version.
    #[error("of another version")]
    Protocol,
    /// Sent by a program whose heartbeat has not arrived yet, or that has not received the hand's messages yet. This is
    /// normal at start-up and not counted as a fault.
    #[error("before their heartbeat")]
    Unintroduced,
    /// Sent by a refused program, or by one that does not send such messages.
    #[error("from unknown senders")]
    Stranger,
    /// The number of fingers, joints, elements or pixels does not match the experiment.
    #[error("of another size")]
    Size,
    /// Contains a number that is not finite.
    #[error("not finite")]
    NotFinite,
    /// Duplicate, or received after a newer message.
    #[error("late or duplicate")]
    Old,
    /// Echoes or contains a step or time in the future.
    #[error("from the future")]
    Future,
    /// Cannot be proven recent: it echoes a step of another run of the hand, or a step that is too old.
    #[error("without proof of age")]
    Unproven,
    /// Stamped by a clock other than the rig's.
    #[error("of another clock")]
    Clock,
    /// Contains a sequence number, stamp or measured value that jumps or is out of range.
    #[error("implausible")]
    Implausible,
}

impl Rejection {
    /// All reasons, in the order of the counters in [`Rejections`].
    const ALL: [Self; 12] = [
        Self::Oversized,
        Self::Malformed,
        Self::Protocol,
        Self::Unintroduced,
        Self::Stranger,
        Self::Size,
        Self::NotFinite,
        Self::Old,
        Self::Future,
        Self::Unproven,
        Self::Clock,
        Self::Implausible,
    ];
}

/// Number of rejected messages, by reason. Displays as in `3 malformed, 1 late or duplicate`, without
/// [`Rejection::Unintroduced`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rejections([u64; Rejection::ALL.len()]);

impl Rejections {
    /// Counts the rejection if `result` is an error.
    pub fn count<T>(&mut self, result: &Result<T, Rejection>) {
        if let Err(rejection) = result {
            self.0[*rejection as usize] += 1;
        }
    }

    /// Returns the number of messages rejected for this reason.
    pub fn of(&self, rejection: Rejection) -> u64 {
        self.0[rejection as usize]
    }

    /// Returns the number of all rejected messages except [`Rejection::Unintroduced`].
    pub fn total(&self) -> u64 {
        self.0.iter().sum::<u64>() - self.of(Rejection::Unintroduced)
    }
}

impl fmt::Display for Rejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        let counted = Rejection::ALL
            .into_iter()
            .filter(|rejection| *rejection != Rejection::Unintroduced && self.of(*rejection) > 0);
        for rejection in counted {
            write!(f, "{separator}{} {rejection}", self.of(rejection))?;
            separator = ", ";
        }
        f.write_str(if self.total() == 0 { "nothing" } else { "" })
    }
}
