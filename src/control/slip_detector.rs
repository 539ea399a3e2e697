//! Slip of each element: the shear that is missing.
//!
//! A feeler that sticks to something at rest is a spring between its tip and a fixed point, so that the
//! fingertip's own motion foretells its next shear force. What is missing from that has been lost by slipping. The
//! paper's detector, by contrast, takes the rate of shear alone ([`FlagAnalyzer`](super::flags::FlagAnalyzer)),
//! to which a feeler that sticks to a fast fingertip looks like one that slips.
//!
//! On something that moves with the fingertip, all that sticks misses shear alike: this detector is for
//! what stands still.

use super::feeler_shape::FeelerShape;
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
    /// Where the fingertip was at the frame before.
    before: Option<FingertipPose>,
    /// Forces at the frame before, N.
    forces: Vec<DVec3>,
    /// Shear lost by slipping since then, N.
    missing: Vec<f64>,
}

impl SlipDetector {
    /// A detector for a finger of `elements` elements that has felt nothing yet.
    pub fn new(feeler: FeelerShape, elements: usize) -> Self {
        Self {
            feeler,
            before: None,
            forces: vec![DVec3::ZERO; elements],
            missing: vec![0.0; elements],
        }
    }

    /// Shear (N) that each element has lost by slipping, as far as can be told from what the stiffness leaves open, with
    /// a part of what it lost before: what slips slips on. About 0 or less where it sticks, touches nothing, or has only
    /// begun to touch. To be called once a frame.
    pub fn detect(&mut self, finger: &FingerSense<'_>) -> &[f64] {
        let now = finger.pose;
        let before = self.before.replace(now).unwrap_or(now);
        let forces = &finger.touch.frame.forces;
        let elements = finger.layout.elements.iter().zip(forces);
        let own = self.forces.iter_mut().zip(&mut self.missing);
        for (index, ((element, force), (last, missing))) in elements.zip(own).enumerate() {
            let carried = (PERSISTENCE * *missing).clamp(0.0, MOST_CARRIED);
            *missing = 0.0;
            if last.z > 0.0 && force.z > 0.0 {
                let tip = finger.layout.tip(index);
                let poses = [before, now].map(|pose| FingertipPose {
                    position: pose.position + pose.rotation * tip,
                    rotation: pose.rotation * element.rotation,
                });
                let foretold = foretold(&self.feeler, &poses, *last).with_z(0.0);
                let lost = (foretold - force.with_z(0.0)).dot(foretold.normalize_or_zero());
                let change = (foretold - last.with_z(0.0)).length();
                *missing = lost - DOUBT * change + carried;
            }
            *last = *force;
        }
        &self.missing
    }
}

/// Force of an element that sticks, after its undeformed tip and frame have gone from one pose to the other;
/// its force before was `last`.
fn foretold(feeler: &FeelerShape, [before, now]: &[FingertipPose; 2], last: DVec3) -> DVec3 {
    // How far the tip is pushed off its rest, in its own frame: back along z, along its shear across it.
    let pushed = DVec3::new(
        last.x / feeler.shear_stiffness,
        last.y / feeler.shear_stiffness,
        -last.z / feeler.normal_stiffness,
    );
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
