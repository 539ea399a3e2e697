//! Stiffness and tip radius of columnar feelers (rubber columns of the sensing elements), and the tip position under
//! load.

use super::sense::FingerReadings;
use crate::check::Checker;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Mechanical properties of a columnar feeler, measured on a test bench.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeelerShape {
    /// Stiffness along the feeler's axis (N/m).
    pub normal_stiffness: f64,
    /// Stiffness across the feeler's axis (N/m).
    pub shear_stiffness: f64,
    /// Radius of the rounded tip (m).
    pub tip_radius: f64,
}

/// Contact stiffness of a feeler (N/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffness {
    /// Stiffness along the feeler's axis (N/m).
    pub normal: f64,
    /// Stiffness across the feeler's axis (N/m).
    pub shear: f64,
}

impl Stiffness {
    /// Displacement of the tip (m) by a `force` (N) on the feeler, both in the element's frame. `force.z` is the
    /// compression, positive when pressed; it displaces the tip along -z.
    pub fn displacement(&self, force: DVec3) -> DVec3 {
        DVec3::new(
            force.x / self.shear,
            force.y / self.shear,
            -force.z / self.normal,
        )
    }
}

impl Default for FeelerShape {
    /// Nominal properties of the reference experiment's fingertip.
    fn default() -> Self {
        Self {
            normal_stiffness: 205.0,
            shear_stiffness: 127.0,
            tip_radius: 0.0021,
        }
    }
}

impl FeelerShape {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("normal_stiffness", self.normal_stiffness),
            ("shear_stiffness", self.shear_stiffness),
            ("tip_radius", self.tip_radius),
        ];
        checker.all_positive(key, &positive);
    }

    /// Contact stiffness of a feeler with these properties.
    pub fn stiffness(&self) -> Stiffness {
        Stiffness {
            normal: self.normal_stiffness,
            shear: self.shear_stiffness,
        }
    }

    /// Centre of the feeler tip of `element` under load (m, in W): the rest position plus the displacement by `force`
    /// (N, in W). `None` if there is no such element.
    pub fn tip(&self, finger: &FingerReadings<'_>, element: usize, force: DVec3) -> Option<DVec3> {
        let axis = finger.normal(element)?;
        let along = force.dot(axis) * axis;
        let yielded = along / self.normal_stiffness + (force - along) / self.shear_stiffness;
        Some(finger.pose.position + finger.layout.dome_radius * axis + yielded)
    }
}
