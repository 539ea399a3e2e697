//! Message with the rumble and the tone that the live page played.

use super::channels::stamped;
use crate::wire::message;
use serde::{Deserialize, Serialize};

/// Rumble and tone that the live page plays from this time on. All values but the times are 0 while nothing is played.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Felt {
    /// Time of the control step at which the page's report arrived (s).
    pub stamp: f64,
    /// Time of the played data (s), or NaN if none.
    pub data_stamp: f64,
    /// Magnitude of the gamepad's low-frequency motor (0 to 1), which follows the grasp force.
    pub rumble_strong: f64,
    /// Magnitude of the gamepad's high-frequency motor (0 to 1), which follows slip.
    pub rumble_weak: f64,
    /// Frequency of the tone (Hz).
    pub tone_frequency: f64,
    /// Gain of the tone (0 to 1).
    pub tone_gain: f64,
}

message!(
    Felt,
    "Felt",
    "# Rumble and tone that the live page plays to its watcher from this time on",
    "float64 stamp  # s, of the control step at which the report of the page arrived",
    "float64 data_stamp  # s, of the played data; NaN if none",
    "float64 rumble_strong  # 0 to 1, low-frequency motor of the gamepad; follows the grasp force",
    "float64 rumble_weak  # 0 to 1, high-frequency motor; follows slip",
    "float64 tone_frequency  # Hz",
    "float64 tone_gain  # 0 to 1; 0 while the tone is silent",
);

impl Felt {
    /// Nothing is played.
    pub const SILENT: Self = Self {
        stamp: 0.0,
        data_stamp: f64::NAN,
        rumble_strong: 0.0,
        rumble_weak: 0.0,
        tone_frequency: 0.0,
        tone_gain: 0.0,
    };

    /// Returns `true` if nothing is played.
    pub fn is_silent(&self) -> bool {
        self.rumble_strong == 0.0 && self.rumble_weak == 0.0 && self.tone_gain == 0.0
    }
}

stamped!(Felt);
