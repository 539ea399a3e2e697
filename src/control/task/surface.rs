//! Where a finger touches: surface points from the forces on its feelers.

use crate::control::sense::FingerSense;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What the task has to know of a feeler, as measured on the fingertip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeelerShape {
    /// Stiffness along its axis, N/m.
    pub normal_stiffness: f64,
    /// Stiffness across its axis, N/m.
    pub shear_stiffness: f64,
    /// Radius of its rounded tip, m.
    pub tip_radius: f64,
}

impl FeelerShape {
    /// Centre of the deformed tip of `element`, m, in W: where the tip is without load, and how far the
    /// force on it has pushed it.
    pub fn tip(&self, finger: &FingerSense<'_>, element: usize) -> Option<DVec3> {
        let axis = finger.normal(element)?;
        let force = finger.force(element);
        let along = force.dot(axis) * axis;
        let yielded = along / self.normal_stiffness + (force - along) / self.shear_stiffness;
        Some(finger.pose.position + finger.layout.dome_radius * axis + yielded)
    }
}

/// The elements with a larger force on them than `touch_force` (N), and that force, N, in W.
///
/// Not only compression counts: a feeler that is caught behind an edge is bent sideways.
pub fn touching<'a>(
    finger: &'a FingerSense<'_>,
    touch_force: f64,
) -> impl Iterator<Item = (usize, DVec3)> + 'a {
    let forces = finger.touch.frame.forces.iter().enumerate();
    let touching = forces.filter(move |(_, force)| force.length() > touch_force);
    touching.map(|(element, _)| (element, finger.force(element)))
}
