//! Slip detectors of the laws that close the fingers while slip is detected.

use super::config::{GripConfig, GripLaw};
use crate::control::grasp_slip::{GraspDrag, GraspDragConfig};
use crate::control::sense::HandReadings;
use crate::control::slip_detector::SlipDetector;
use crate::sensor::fingertip::MAX_ELEMENTS;

/// Slip detector of a law.
#[derive(Debug, Clone)]
pub(super) enum SlipSignal {
    /// The paper's SLIP flag.
    Flag,
    /// Missing shear of an element: threshold (N), and one detector per finger.
    MissingShear(f64, Vec<SlipDetector>),
    /// Drag of a finger: threshold (N), and one detector per finger.
    Drag(f64, Vec<GraspDrag>),
}

impl SlipSignal {
    /// Creates the detector of the configured law; `None` if the law does not use one.
    pub fn new(config: &GripConfig) -> Option<Self> {
        let (own, fingers) = (&config.slip_reflex, config.finger.len());
        match config.law {
            GripLaw::Reflex => Some(Self::Flag),
            GripLaw::MissingShear => {
                let (feeler, touch_force) = (config.feeler, config.touch_force);
                let detector = SlipDetector::for_movable_object(feeler, touch_force, MAX_ELEMENTS);
                Some(Self::MissingShear(
                    own.missing_shear,
                    vec![detector; fingers],
                ))
            }
            GripLaw::Drag => {
                // Forces in newtons.
                let detector = GraspDrag::new(MAX_ELEMENTS, 1.0, GraspDragConfig::default());
                let detectors = detector.map_or_else(|_| Vec::new(), |d| vec![d; fingers]);
                Some(Self::Drag(own.drag, detectors))
            }
            GripLaw::PartialSlip | GripLaw::KnownFriction | GripLaw::Fixed | GripLaw::Policy => {
                None
            }
        }
    }

    /// Returns whether the object slips, given readings taken `interval` (s) after the previous ones. Must be called
    /// once per frame.
    pub fn slips(&mut self, hand: &HandReadings<'_>, interval: f64) -> bool {
        match self {
            Self::Flag => hand.fingers().any(|finger| finger.flags().slip),
            Self::MissingShear(threshold, detectors) => {
                let mut slips = false;
                for (finger, detector) in hand.fingers().zip(detectors) {
                    let missing = detector.detect(&finger);
                    slips |= missing.iter().any(|missing| missing > threshold);
                }
                slips
            }
            Self::Drag(threshold, detectors) => {
                let mut slips = false;
                for (finger, detector) in hand.fingers().zip(detectors) {
                    let forces = finger.touch.frame.forces.iter().copied();
                    let drag = detector.update(interval, forces);
                    slips |= drag.is_some_and(|drag| drag > *threshold);
                }
                slips
            }
        }
    }
}
