//! Slip of each element: the shear that is missing.
//!
//! A feeler that sticks to something at rest is a spring between its tip and a fixed point, so that the
//! fingertip's own motion foretells its next shear force. What is missing from that has been lost by slipping. The
//! paper's detector, by contrast, takes the rate of shear alone ([`FlagAnalyzer`](super::flags::FlagAnalyzer)),
//! to which a feeler that sticks to a fast fingertip looks like one that slips.
//!
//! On an object that goes along with the fingertip, all that sticks misses shear alike, for its springs are not
//! stretched by the whole way of the fingertip. [`SlipDetector::on_what_may_move`] takes what every touching
//! element misses for that. A dragged object goes no farther than what drags it, so whatever misses more than all that the
//! fingertip's motion foretells has slipped. Where all that touch slip alike, and by less than that, it sees none of them.

use super::feeler_shape::{FeelerShape, Stiffness};
use super::sense::{FingerSense, FingertipPose};
use glam::DVec3;

/// What part of the change of shear that is foretold may be missing because the rubber is softer than it is thought to be.
const DOUBT: f64 = 0.08;
/// What part of what was missing at the frame before counts at this one…
const PERSISTENCE: f64 = 0.8;
/// …up to this, N: by itself too little to be called slip.
const MOST_CARRIED: f64 = 0.004;

/// Foretells shear from frame to frame.
#[derive(Debug, Clone)]
pub struct SlipDetector {
    /// What the hand knows of its own feelers.
    feeler: FeelerShape,
    /// Only elements that are pressed harder than this in two frames are looked at, N.
    touch_force: f64,
    /// Whether what is touched may move.
    may_move: bool,
    /// Where the fingertip was at the frame before.
    before: Option<FingertipPose>,
    /// Forces at the frame before, N.
    forces: Vec<DVec3>,
    /// Shear foretold for this frame on what stands still, N, of each element that is looked at.
    foretold: Vec<Option<DVec3>>,
    /// Shear lost by slipping since the frame before, N.
    missing: Vec<f64>,
}

impl SlipDetector {
    /// A detector for a finger of `elements` elements that has felt nothing yet, and touches what stands still.
    pub fn new(feeler: FeelerShape, elements: usize) -> Self {
        Self {
            feeler,
            touch_force: 0.0,
            may_move: false,
            before: None,
            forces: vec![DVec3::ZERO; elements],
            foretold: vec![None; elements],
            missing: vec![0.0; elements],
        }
    }

    /// The same for what may move along with the fingertip. Only elements that are pressed harder than `touch_force` (F1), N,
    /// are looked at: those that hold on to nothing would have no say in whether it moves.
    pub fn on_what_may_move(feeler: FeelerShape, touch_force: f64, elements: usize) -> Self {
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

    /// Shear (N) that each element has lost by slipping, as far as can be told from what the stiffness leaves open, with
    /// a part of what it lost before: what slips slips on. About 0 or less where it sticks, touches nothing, or has only
    /// begun to touch. To be called once a frame.
    pub fn detect(&mut self, finger: &FingerSense<'_>) -> &[f64] {
        let along = self.foretell(finger);
        self.detect_on(finger, along)
    }

    /// Predicts the shear of this frame. Returns the part of the fingertip's motion that the touched object may have followed,
    /// 0 to 1, judged by this finger alone. To be called once a frame, before [`detect_on`](Self::detect_on).
    pub fn foretell(&mut self, finger: &FingerSense<'_>) -> f64 {
        self.predict(finger);
        self.gone_along(&finger.touch.frame.forces)
    }

    /// Like [`detect`](Self::detect), but on an object that has followed the part `along` of the fingertip's motion, 0 to 1.
    pub fn detect_on(&mut self, finger: &FingerSense<'_>, along: f64) -> &[f64] {
        let forces = &finger.touch.frame.forces;
        let own = self.forces.iter_mut().zip(&mut self.missing);
        for ((force, foretold), (last, missing)) in forces.iter().zip(&self.foretold).zip(own) {
            let carried = (PERSISTENCE * *missing).clamp(0.0, MOST_CARRIED);
            *missing = 0.0;
            if let Some(still) = foretold {
                let change = *still - last.with_z(0.0);
                let foretold = *still - along * change;
                let lost = (foretold - force.with_z(0.0)).dot(foretold.normalize_or_zero());
                *missing = lost - DOUBT * change.length() + carried;
            }
            *last = *force;
        }
        &self.missing
    }

    /// Foretells the shear of every element that touched at the frame before and does now.
    fn predict(&mut self, finger: &FingerSense<'_>) {
        let now = finger.pose;
        let before = self.before.replace(now).unwrap_or(now);
        let elements = finger.layout.elements.iter();
        let forces = finger.touch.frame.forces.iter().zip(&self.forces);
        let elements = elements.zip(forces).zip(&mut self.foretold);
        for (index, ((element, (force, last)), foretold)) in elements.enumerate() {
            let touches = last.z.min(force.z) > self.touch_force;
            *foretold = touches.then(|| {
                let tip = finger.layout.tip(index);
                let poses = [before, now].map(|pose| FingertipPose {
                    position: pose.position + pose.rotation * tip,
                    rotation: pose.rotation * element.rotation,
                });
                foretold_force(&self.feeler, &poses, *last).with_z(0.0)
            });
        }
    }

    /// What part of the fingertip's way what it touches has gone along, 0 to 1: the least part of what was foretold that is
    /// missing from any touching element. All of it where none touches.
    fn gone_along(&self, forces: &[DVec3]) -> f64 {
        if !self.may_move {
            return 0.0;
        }
        let elements = forces.iter().zip(&self.forces).zip(&self.foretold);
        let parts = elements.filter_map(|((force, last), foretold)| {
            let foretold = (*foretold)?;
            let change = foretold - last.with_z(0.0);
            let missing = (foretold - force.with_z(0.0)).dot(change);
            let whole = change.length_squared();
            (whole > 0.0).then(|| (missing / whole).clamp(0.0, 1.0))
        });
        parts.fold(1.0, f64::min)
    }
}

/// Force of an element that sticks, after its undeformed tip and frame have gone from one pose to the other;
/// its force before was `last`.
fn foretold_force(feeler: &FeelerShape, [before, now]: &[FingertipPose; 2], last: DVec3) -> DVec3 {
    // How far the tip is pushed off its rest, in its own frame: back along z, along its shear across it.
    let pushed = feeler.stiffness().displacement(last);
    let held = before.position + before.rotation * pushed;
    // The tip's sphere rolls as the fingertip turns, on a surface that faces the feeler.
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
