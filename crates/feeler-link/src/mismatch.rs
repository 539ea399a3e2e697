//! In what programs of a rig do not agree.

use super::message::PROTOCOL;

/// In what a program does not agree with this one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
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
    /// There is one like it already.
    #[error("there is {program} already")]
    Taken {
        /// What there is.
        program: String,
    },
}

impl Mismatch {
    /// Whether it stays, whatever other programs do.
    pub fn is_final(&self) -> bool {
        !matches!(self, Self::Taken { .. })
    }
}

/// As much of a hash as a person compares.
pub(super) fn short(hash: &str) -> String {
    match hash.get(..12) {
        Some(start) => start.into(),
        None if hash.is_empty() => "none".into(),
        None => hash.into(),
    }
}
