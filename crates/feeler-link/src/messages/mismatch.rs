//! Mismatches between the programs of a rig.

use super::message::PROTOCOL;
use super::printable::printable;

/// Mismatch between another program and this one, which refuses the other one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// Different protocol version.
    #[error(
        "{program} (feeler {version}) uses protocol version {theirs}, this program (feeler {}) uses version {PROTOCOL}",
        env!("CARGO_PKG_VERSION")
    )]
    Protocol {
        /// The other program.
        program: String,
        /// Its version of feeler.
        version: String,
        /// Its protocol version.
        theirs: u32,
    },
    /// Different experiment.
    #[error(
        "{program} runs experiment {theirs}, this program {ours}: start both with the same file and settings"
    )]
    Experiment {
        /// The other program.
        program: String,
        /// First digits of the SHA-256 of its experiment.
        theirs: String,
        /// First digits of the SHA-256 of this program's experiment.
        ours: String,
    },
    /// Different fingertip.
    #[error(
        "{program} uses fingertip {theirs}, the experiment {ours}: start it with the experiment's layout"
    )]
    Fingertip {
        /// The other program.
        program: String,
        /// First digits of the SHA-256 of its fingertip.
        theirs: String,
        /// First digits of the SHA-256 of the experiment's fingertip.
        ours: String,
    },
    /// Different speed of experiment time.
    #[error("{program} runs at {}, this hand at {}: start both with the same --speed", speed(*theirs), speed(*ours))]
    Speed {
        /// The other program.
        program: String,
        /// Its ratio of experiment time to real time, or 0 in lockstep.
        theirs: f64,
        /// Ratio that this program expects.
        ours: f64,
    },
    /// Another program already has this role.
    #[error("{program} is already running")]
    Taken {
        /// The program that has the role.
        program: String,
    },
}

fn speed(times: f64) -> String {
    match times {
        0.0 => "the pace of the hand's answers (max)".into(),
        times => format!("{times} times real time"),
    }
}

/// Returns the first 12 digits of a hash, for display.
pub(crate) fn short(hash: &str) -> String {
    match hash.get(..12) {
        Some(start) => printable(start),
        None if hash.is_empty() => "none".into(),
        None => printable(hash),
    }
}
