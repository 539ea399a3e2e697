//! What a hand knows of its own feelers, and where their tips are by the forces on them.

use super::sense::FingerSense;
use crate::check::Checker;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A feeler as measured on the fingertip, on a bench.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeelerShape {
    /// Stiffness along its axis, N/m.
    pub normal_stiffness: f64,
    /// Stiffness across its axis, N/m.
    pub shear_stiffness: f64,
    /// Radius of its rounded tip, m.
    pub tip_radius: f64,
}

/// Contact stiffness of one feeler, N/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffness {
    /// Along its axis.
    pub normal: f64,
    /// Across its axis.
    pub shear: f64,
}

impl Stiffness {
    /// Displacement of the tip by a `force` on the feeler, m: force (N) and displacement in the element's frame, with the
    /// force in z positive where the feeler is pressed, back along z.
    pub fn displacement(&self, force: DVec3) -> DVec3 {
        DVec3::new(
            force.x / self.shear,
            force.y / self.shear,
            -force.z / self.normal,
        )
    }
}

impl Default for FeelerShape {
    /// The nominal rubber of the reference experiment's fingertip.
    fn default() -> Self {
        Self {
            normal_stiffness: 205.0,
            shear_stiffness: 127.0,
            tip_radius: 0.0021,
        }
    }
}

impl FeelerShape {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("normal_stiffness", self.normal_stiffness),
            ("shear_stiffness", self.shear_stiffness),
            ("tip_radius", self.tip_radius),
        ];
        checker.all_positive(key, &positive);
    }

    /// Its contact stiffness.
    pub fn stiffness(&self) -> Stiffness {
        Stiffness {
            normal: self.normal_stiffness,
            shear: self.shear_stiffness,
        }
    }

    /// Centre of the deformed tip of `element`, m, in W: where the tip is without load, and how far the
    /// `force` on it, N, in W, has pushed it.
    pub fn tip(&self, finger: &FingerSense<'_>, element: usize, force: DVec3) -> Option<DVec3> {
        let axis = finger.normal(element)?;
        let along = force.dot(axis) * axis;
        let yielded = along / self.normal_stiffness + (force - along) / self.shear_stiffness;
        Some(finger.pose.position + finger.layout.dome_radius * axis + yielded)
    }
}
