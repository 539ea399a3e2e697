//! What a recording holds, and how it reaches its file.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// How old a message may be before it is handed to the system, s of the run's time, unless somebody says otherwise.
pub const FLUSH_INTERVAL: f64 = 1.0;

/// What a recording holds beside the messages that every run has, and how it reaches its file.
#[derive(Debug, Clone)]
pub struct RecordOptions {
    /// The text of each calibration file that the experiment names, by that name. They are no part of the
    /// digest: another calibration shows in the forces.
    pub calibrations: BTreeMap<String, String>,
    /// The policy that the experiment names as its control law, if it does. It is no part of the digest: another policy
    /// shows in the commands.
    pub policy: Option<PolicyFile>,
    /// Whether there will be pictures.
    pub pictures: bool,
    /// What a write does while the file takes nothing.
    pub patience: Patience,
    /// How old a message may be before it is handed to the system, s of the run's time: what a program that is
    /// killed loses at most, and 512 KiB where that is less. Every time costs 0.6 KB of the file.
    pub flush_interval: f64,
}

impl Default for RecordOptions {
    fn default() -> Self {
        Self {
            calibrations: BTreeMap::new(),
            policy: None,
            pictures: false,
            patience: Patience::default(),
            flush_interval: FLUSH_INTERVAL,
        }
    }
}

/// The file of a learnt policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolicyFile {
    /// As the experiment names it.
    pub name: String,
    /// What it holds.
    pub bytes: Arc<[u8]>,
}

/// What a write does while the file takes nothing and no more messages can wait for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Patience {
    /// It waits for ever, and a file that fails is its error. For a run whose time is simulated: nothing is lost.
    #[default]
    Unlimited,
    /// It waits so long, and not again until there was room; then messages are dropped, counted, and told of by a
    /// [`RecordingGap`](super::RecordingGap). A file that fails is no error of a write either: all later messages are
    /// dropped, and [`Recorder::failure`](super::Recorder::failure) says why. For a hand that moves meanwhile.
    Limited(Duration),
}
