//! Options of a recording.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// Default of [`RecordOptions::flush_interval`] (s).
pub const FLUSH_INTERVAL: f64 = 1.0;

/// Optional content of a recording, and how it is written to its file.
#[derive(Debug, Clone)]
pub struct RecordOptions {
    /// Text of each calibration file named in the experiment, by name. Not part of the digest, because the recorded
    /// forces show a change of calibration.
    pub calibrations: BTreeMap<String, String>,
    /// Learned policy, if the experiment names one as its control law. Not part of the digest, because the recorded
    /// commands show a change of policy.
    pub policy: Option<PolicyFile>,
    /// `true` if images will be recorded.
    pub pictures: bool,
    /// `true` if rumble and tone of the live page will be recorded.
    pub felt: bool,
    /// `true` if efforts of the drives will be recorded.
    pub efforts: bool,
    /// `true` if tactile frames between control steps will be recorded, which only sensors in other programs or on other
    /// threads measure.
    pub samples: bool,
    /// Behaviour of writes while the file accepts no data.
    pub patience: Backpressure,
    /// Maximum age of a message before it is passed to the operating system, in seconds of run time. A program that is
    /// killed loses at most this, or 512 KiB if that is less. Each time costs 0.6 KB of the file.
    pub flush_interval: f64,
}

impl Default for RecordOptions {
    fn default() -> Self {
        Self {
            calibrations: BTreeMap::new(),
            policy: None,
            pictures: false,
            felt: false,
            efforts: false,
            samples: false,
            patience: Backpressure::default(),
            flush_interval: FLUSH_INTERVAL,
        }
    }
}

/// File of a learned policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolicyFile {
    /// Name in the experiment.
    pub name: String,
    /// Contents of the file.
    pub bytes: Arc<[u8]>,
}

/// Behaviour of a write while the file accepts no data and the queue is full.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Backpressure {
    /// Wait indefinitely. A write returns the file's error. For simulated runs: no message is lost.
    #[default]
    Unlimited,
    /// Wait up to this duration, and not again until there is space. Then drop and count messages, and write a
    /// [`RecordingGap`](crate::RecordingGap). A write does not return the file's error: all later messages are dropped,
    /// and [`Recorder::failure`](crate::Recorder::failure) returns the reason. For a hand that moves during recording.
    Limited(Duration),
}
