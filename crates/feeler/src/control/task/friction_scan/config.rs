//! What a friction scan is tuned by.

use serde::{Deserialize, Serialize};

/// Where the finger presses and how it slides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionScanConfig {
    /// Where the dome's centre starts from, m, in W.
    pub home: [f64; 3],
    /// Direction in which the finger presses, in W; its length does not matter. The specimen need not face it exactly.
    pub approach: [f64; 3],
    /// Direction in which it slides first, in W; only what is across the approach counts, and not its length.
    pub slide: [f64; 3],
    /// Speed of the approach, m/s.
    pub search_speed: f64,
    /// A finger that has come this far from home and feels no specimen stops the task, m.
    pub search_limit: f64,
    /// Force with which it presses, N.
    pub load: f64,
    /// Speed at which it presses harder for each newton that is missing, m/(s N).
    pub load_gain: f64,
    /// How long it presses before it slides, s; the noise of its forces is measured in the second half.
    pub settle_time: f64,
    /// Speed of sliding, m/s.
    pub slide_speed: f64,
    /// How far it slides in a stroke after the first slip, m.
    pub travel: f64,
    /// A stroke that has come this far without a slip ends the task, m.
    pub slide_limit: f64,
    /// Strokes, back and forth in turn, at least 3: the first one does not count.
    pub strokes: u32,
    /// Speed of release and return, m/s.
    pub return_speed: f64,
    /// The finger is home within this distance, m.
    pub home_tolerance: f64,
}
