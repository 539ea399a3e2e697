//! Detects slip of single elements from missing shear.
//!
//! A feeler that sticks to an object at rest acts as a spring between its base and a fixed point, so its next shear
//! force can be predicted from the fingertip's motion. Shear that is missing compared with the prediction has been lost
//! by slipping. The paper's detector uses only the shear rate ([`FlagAnalyzer`](super::flags::FlagAnalyzer)) and cannot
//! distinguish a feeler that slips from one that sticks to a fast fingertip.
//!
//! On an object that moves along with the fingertip, all sticking elements miss the same fraction of the predicted
//! change, because their springs are stretched by only a part of the fingertip's motion.
//! [`SlipDetector::for_movable_object`] attributes the fraction that is missing on every element in contact to the
//! object's motion. A dragged object moves no farther than the fingertip, so an element that misses more than the
//! entire predicted change has slipped. If all elements in contact slip alike by less than that, the slip is not
//! detected.

use super::feeler_shape::{FeelerShape, Stiffness};
use super::sense::{FingerReadings, FingertipPose};
use glam::DVec3;

/// Fraction of the predicted shear change that may be missing because the stiffness is uncertain.
const DOUBT: f64 = 0.08;
/// Fraction of the shear missing at the previous frame that is added to the next frame.
const PERSISTENCE: f64 = 0.8;
/// Maximum shear that is added from the previous frame (N), too small to count as slip by itself.
const MAX_CARRIED: f64 = 0.004;

/// Predicts the shear of each element from frame to frame and reports the missing part.
#[derive(Debug, Clone)]
pub struct SlipDetector {
    /// Stiffness and tip radius of the columnar feelers.
    feeler: FeelerShape,
    /// Compression (N) that an element must exceed in two consecutive frames to be evaluated.
    touch_force: f64,
    /// `true` if the object may move along with the fingertip.
    may_move: bool,
    /// Fingertip pose at the previous frame.
    before: Option<FingertipPose>,
    /// Forces at the previous frame (N).
    forces: Vec<DVec3>,
    /// Predicted shear for an object at rest (N); `None` for elements that are not evaluated.
    predicted: Vec<Option<DVec3>>,
    /// Shear lost by slipping since the previous frame (N).
    missing: Vec<f64>,
}

impl SlipDetector {
    /// Creates a detector for a finger of `elements` elements that is in contact with an object at rest.
    pub fn new(feeler: FeelerShape, elements: usize) -> Self {
        Self {
            feeler,
            touch_force: 0.0,
            may_move: false,
            before: None,
            forces: vec![DVec3::ZERO; elements],
            predicted: vec![None; elements],
            missing: vec![0.0; elements],
        }
    }

    /// Creates a detector for an object that may move along with the fingertip. Only elements with a compression above
    /// `touch_force` (F1, N) are evaluated, because less compressed elements carry no information about the object's
    /// motion.
    pub fn for_movable_object(feeler: FeelerShape, touch_force: f64, elements: usize) -> Self {
        Self {
            touch_force,
            may_move: true,
            ..Self::new(feeler, elements)
        }
    }

    /// Sets the contact stiffness of the feelers.
    pub fn set_stiffness(&mut self, stiffness: Stiffness) {
        self.feeler.normal_stiffness = stiffness.normal;
        self.feeler.shear_stiffness = stiffness.shear;
    }

    /// Returns the shear (N) that each element has lost by slipping, less a margin for the uncertain stiffness, plus a
    /// part of its earlier loss, because a slipping element tends to keep slipping. It is about 0 or negative for
    /// elements that stick, are not in contact, or have just come into contact. Must be called once per frame.
    pub fn detect(&mut self, finger: &FingerReadings<'_>) -> &[f64] {
        let along = self.predict_shear(finger);
        self.detect_on(finger, along)
    }

    /// Predicts the shear of this frame. Returns the fraction (0 to 1) of the fingertip's motion that the object may
    /// have followed, estimated from this finger alone. Must be called once per frame, before
    /// [`detect_on`](Self::detect_on).
    pub fn predict_shear(&mut self, finger: &FingerReadings<'_>) -> f64 {
        self.predict(finger);
        self.gone_along(&finger.touch.frame.forces)
    }

    /// Like [`detect`](Self::detect), but for an object that has followed the fraction `along` (0 to 1) of the
    /// fingertip's motion.
    pub fn detect_on(&mut self, finger: &FingerReadings<'_>, along: f64) -> &[f64] {
        let forces = &finger.touch.frame.forces;
        let own = self.forces.iter_mut().zip(&mut self.missing);
        for ((force, predicted), (last, missing)) in forces.iter().zip(&self.predicted).zip(own) {
            let carried = (PERSISTENCE * *missing).clamp(0.0, MAX_CARRIED);
            *missing = 0.0;
            if let Some(still) = predicted {
                let change = *still - last.with_z(0.0);
                let predicted = *still - along * change;
                let lost = (predicted - force.with_z(0.0)).dot(predicted.normalize_or_zero());
                *missing = lost - DOUBT * change.length() + carried;
            }
            *last = *force;
        }
        &self.missing
    }

    /// Predicts the shear of every element that is in contact in both the previous and the current frame.
    fn predict(&mut self, finger: &FingerReadings<'_>) {
        let now = finger.pose;
        let before = self.before.replace(now).unwrap_or(now);
        let elements = finger.layout.elements.iter();
        let forces = finger.touch.frame.forces.iter().zip(&self.forces);
        let elements = elements.zip(forces).zip(&mut self.predicted);
        for (index, ((element, (force, last)), predicted)) in elements.enumerate() {
            let touches = last.z.min(force.z) > self.touch_force;
            *predicted = touches.then(|| {
                let tip = finger.layout.tip(index);
                let poses = [before, now].map(|pose| FingertipPose {
                    position: pose.position + pose.rotation * tip,
                    rotation: pose.rotation * element.rotation,
                });
                foretold_force(&self.feeler, &poses, *last).with_z(0.0)
            });
        }
    }

    /// Fraction (0 to 1) of the fingertip's motion that the object has followed: the smallest fraction of the predicted
    /// change that is missing on any element in contact. 1 if no element is in contact.
    fn gone_along(&self, forces: &[DVec3]) -> f64 {
        if !self.may_move {
            return 0.0;
        }
        let elements = forces.iter().zip(&self.forces).zip(&self.predicted);
        let parts = elements.filter_map(|((force, last), predicted)| {
            let predicted = (*predicted)?;
            let change = predicted - last.with_z(0.0);
            let missing = (predicted - force.with_z(0.0)).dot(change);
            let whole = change.length_squared();
            (whole > 0.0).then(|| (missing / whole).clamp(0.0, 1.0))
        });
        parts.fold(1.0, f64::min)
    }
}

/// Predicts the force on a sticking element whose undeformed tip moves from the pose `before` to the pose `now`. `last`
/// is its previous force.
fn foretold_force(feeler: &FeelerShape, [before, now]: &[FingertipPose; 2], last: DVec3) -> DVec3 {
    // Displacement of the tip from rest in its own frame: along -z by the compression, across by the shear.
    let pushed = feeler.stiffness().displacement(last);
    let held = before.position + before.rotation * pushed;
    // The spherical tip rolls as the fingertip rotates, on a surface that faces the feeler.
    let twice = before.rotation.x_axis.cross(now.rotation.x_axis)
        + before.rotation.y_axis.cross(now.rotation.y_axis)
        + before.rotation.z_axis.cross(now.rotation.z_axis);
    let rolled = feeler.tip_radius * (0.5 * twice).cross(-before.rotation.z_axis);
    let pushed = now.rotation.transpose() * (held + rolled - now.position);
    DVec3::new(
        pushed.x * feeler.shear_stiffness,
        pushed.y * feeler.shear_stiffness,
        -pushed.z * feeler.normal_stiffness,
    )
}
