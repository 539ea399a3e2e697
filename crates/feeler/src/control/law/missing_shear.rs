//! The paper's law with another slip detector: shear that is missing compared with the prediction from the fingertip's
//! own motion ([`SlipDetector`]), instead of the shear rate.
//!
//! The detector needs the fingertip's pose, which sensor programs do not have, so it runs in the control law. The SLIP
//! flag of the sensors, which is recorded, remains the paper's.

use super::Law;
use super::tri_axial::{Reflex, TriAxialLaw};
use crate::check::Checker;
use crate::control::feeler_shape::FeelerShape;
use crate::control::flags::FingerFlags;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use crate::control::slip_detector::SlipDetector;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Parameters of slip detection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MissingShearConfig {
    /// Missing shear above which an element counts as slipping (N).
    pub threshold: f64,
    /// Stiffness and tip radius of the columnar feelers.
    pub feeler: FeelerShape,
}

impl Default for MissingShearConfig {
    /// Threshold chosen by `feeler score-slip` for a precision of 96 % on objects that may move.
    fn default() -> Self {
        Self {
            threshold: 0.0098,
            feeler: FeelerShape::default(),
        }
    }
}

impl MissingShearConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.positive(&format!("{key}.threshold"), self.threshold);
        self.feeler.check(&format!("{key}.feeler"), checker);
    }
}

/// State of the law for one finger, with its slip detector.
#[derive(Debug, Clone)]
pub struct MissingShear {
    estimator: TriAxialLaw,
    detector: SlipDetector,
    threshold: f64,
    /// Sequence number of the latest evaluated frame.
    newest: Option<u64>,
    /// `true` if an element slipped in the latest evaluated frame.
    slip: bool,
}

impl MissingShear {
    /// Creates the law for a finger of `elements` elements, which are in contact above `touch_force` (F1, N).
    pub fn new(
        config: &MissingShearConfig,
        reflex: Reflex,
        touch_force: f64,
        elements: usize,
    ) -> Self {
        Self {
            estimator: TriAxialLaw::new(reflex),
            // The cap turns with the fingers until it is closed.
            detector: SlipDetector::for_movable_object(config.feeler, touch_force, elements),
            threshold: config.threshold,
            newest: None,
            slip: false,
        }
    }

    /// Returns whether an element slips in the latest frame. Returns the previous result if there is no newer frame.
    fn slips(&mut self, finger: &FingerReadings<'_>) -> bool {
        let frame = &finger.touch.frame;
        if self.newest.replace(frame.sequence) != Some(frame.sequence) {
            let missing = self.detector.detect(finger);
            self.slip = missing.iter().any(|&missing| missing > self.threshold);
        }
        self.slip
    }
}

impl Law for MissingShear {
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        let slip = self.slips(finger);
        let flags = finger.flags();
        let flags = FingerFlags {
            // An element that slips here is pressed, so TOUCH does not depend on SLIP.
            touch: flags.largest_element.is_some(),
            slip,
            ..*flags
        };
        let pressing = flags.largest_element.and_then(|e| finger.normal(e));
        self.estimator.estimate(plan, &flags, pressing)
    }
}
