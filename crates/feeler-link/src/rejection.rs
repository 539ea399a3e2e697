//! Messages that are not taken, and how many.

use std::fmt;

/// Why a message was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Rejection {
    /// It is longer than any such message.
    #[error("too long")]
    Oversized,
    /// Its bytes are not those of such a message.
    #[error("malformed")]
    Malformed,
    /// It is of another version.
    #[error("of another version")]
    Protocol,
    /// It is of a program that has not said yet what it is, or that has not heard of the hand yet. That is no fault:
    /// its next messages do.
    #[error("before their heartbeat")]
    Unintroduced,
    /// It is of a program that was refused, or of none that sends such messages.
    #[error("from strangers")]
    Stranger,
    /// It is for another number of fingers, elements or pixels.
    #[error("of another size")]
    Size,
    /// It holds a number that is not finite.
    #[error("not finite")]
    NotFinite,
    /// It came before, or after a later one.
    #[error("late or twice")]
    Old,
    /// It tells of what has not happened yet.
    #[error("from a time to come")]
    Future,
    /// It does not prove its age: it echoes another run of a hand, or a step too long ago.
    #[error("without proof of their age")]
    Unproven,
    /// It is stamped by a clock that is not the rig's.
    #[error("of another clock")]
    Clock,
    /// A number in it cannot be true: a sequence, a stamp or a measured value that jumps or has no such size.
    #[error("implausible")]
    Implausible,
}

impl Rejection {
    /// All of them, in the order of [`Rejections`].
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

/// How many messages were not taken, by reason. Shows as in `3 malformed, 1 late or twice`; messages of
/// programs that had not said yet what they are, or not heard of the hand, do not count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rejections([u64; Rejection::ALL.len()]);

impl Rejections {
    /// Counts what was rejected, if `result` is that.
    pub fn count<T>(&mut self, result: &Result<T, Rejection>) {
        if let Err(rejection) = result {
            self.0[*rejection as usize] += 1;
        }
    }

    /// How many were rejected for `rejection`.
    pub fn of(&self, rejection: Rejection) -> u64 {
        self.0[rejection as usize]
    }

    /// How many count.
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
