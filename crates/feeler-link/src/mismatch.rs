//! In what programs of a rig do not agree.

use super::message::PROTOCOL;
use super::printable::printable;

/// In what a program does not agree with this one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// It speaks another version of the messages.
    #[error(
        "{program} (feeler {version}) speaks version {theirs} of the messages, this feeler {} version {PROTOCOL}",
        env!("CARGO_PKG_VERSION")
    )]
    Protocol {
        /// What the program is.
        program: String,
        /// Version of feeler that it is.
        version: String,
        /// Version of its messages.
        theirs: u32,
    },
    /// It works by another experiment.
    #[error(
        "{program} works by experiment {theirs}, this by {ours}: start both with the same file and settings"
    )]
    Experiment {
        /// What the program is.
        program: String,
        /// The beginning of the SHA-256 of its experiment.
        theirs: String,
        /// That of this program's.
        ours: String,
    },
    /// It senses by another fingertip.
    #[error(
        "{program} senses by fingertip {theirs}, the experiment's is {ours}: its layout is another"
    )]
    Fingertip {
        /// What the program is.
        program: String,
        /// The beginning of the SHA-256 of its fingertip.
        theirs: String,
        /// That of the experiment's.
        ours: String,
    },
    /// Its time goes at another speed.
    #[error("{program} goes at {}, this hand at {}: start both with the same --speed", speed(*theirs), speed(*ours))]
    Speed {
        /// What the program is.
        program: String,
        /// Seconds of the rig in a second; 0 where it waits for the hand.
        theirs: f64,
        /// Those that this program expects.
        ours: f64,
    },
    /// There is one like it already.
    #[error("there is {program} already")]
    Taken {
        /// What there is.
        program: String,
    },
}

fn speed(times: f64) -> String {
    match times {
        0.0 => "the pace of the hand's answers (max)".into(),
        times => format!("{times} times real time"),
    }
}

/// As much of a hash as a person compares.
pub(super) fn short(hash: &str) -> String {
    match hash.get(..12) {
        Some(start) => printable(start),
        None if hash.is_empty() => "none".into(),
        None => printable(hash),
    }
}
