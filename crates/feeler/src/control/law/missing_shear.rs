//! The paper's law with another source of SLIP: the shear that is missing from what the fingertip's own motion
//! foretells ([`SlipDetector`]), instead of the rate of shear.
//!
//! It needs the fingertip's pose, which a sensor's program does not know; so it is the hand's to look for slip, and the
//! SLIP that sensors raise, and that is recorded, stays the paper's.

use super::Law;
use super::tri_axial::{FingerSpeedEstimator, Reflex};
use crate::check::Checker;
use crate::control::feeler_shape::FeelerShape;
use crate::control::flags::FingerFlags;
use crate::control::plan::Plan;
use crate::control::sense::FingerSense;
use crate::control::slip_detector::SlipDetector;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What slip is told by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MissingShearConfig {
    /// An element that misses more shear than this slips, N.
    pub threshold: f64,
    /// What the hand knows of its own feelers.
    pub feeler: FeelerShape,
}

impl Default for MissingShearConfig {
    /// The threshold that `feeler score-slip` chooses for a precision of 96 % on what may move.
    fn default() -> Self {
        Self {
            threshold: 0.0098,
            feeler: FeelerShape::default(),
        }
    }
}

impl MissingShearConfig {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.positive(&format!("{key}.threshold"), self.threshold);
        self.feeler.check(&format!("{key}.feeler"), checker);
    }
}

/// One finger that is moved as the paper has it, and looks for slip itself.
#[derive(Debug, Clone)]
pub struct MissingShear {
    estimator: FingerSpeedEstimator,
    detector: SlipDetector,
    threshold: f64,
    /// Sequence number of the newest frame that was looked at.
    newest: Option<u64>,
    /// Whether an element slipped by that frame.
    slip: bool,
}

impl MissingShear {
    /// A finger of `elements` elements at rest, which touch where they are pressed harder than `touch_force` (F1), N.
    pub fn new(
        config: &MissingShearConfig,
        reflex: Reflex,
        touch_force: f64,
        elements: usize,
    ) -> Self {
        Self {
            estimator: FingerSpeedEstimator::new(reflex),
            // The cap turns with the fingers until it is closed.
            detector: SlipDetector::on_what_may_move(config.feeler, touch_force, elements),
            threshold: config.threshold,
            newest: None,
            slip: false,
        }
    }

    /// Whether an element slips, by the newest frame; the same again until there is a newer one.
    fn slips(&mut self, finger: &FingerSense<'_>) -> bool {
        let frame = &finger.touch.frame;
        if self.newest.replace(frame.sequence) != Some(frame.sequence) {
            let missing = self.detector.detect(finger);
            self.slip = missing.iter().any(|&missing| missing > self.threshold);
        }
        self.slip
    }
}

impl Law for MissingShear {
    fn velocity(&mut self, plan: &Plan, finger: &FingerSense<'_>) -> DVec3 {
        let slip = self.slips(finger);
        let flags = finger.flags();
        let flags = FingerFlags {
            // What slips here is pressed, so that TOUCH needs no word of SLIP.
            touch: flags.largest_element.is_some(),
            slip,
            ..*flags
        };
        let pressing = flags.largest_element.and_then(|e| finger.normal(e));
        self.estimator.estimate(plan, &flags, pressing)
    }
}
