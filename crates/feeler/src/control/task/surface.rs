//! Elements of a finger that are in contact.

use crate::control::sense::FingerReadings;
use glam::DVec3;

/// Iterates over the elements with a force above `touch_force` (N), with the force on each element (N, in W).
///
/// Uses the magnitude of the force, not only compression, because a feeler that is caught behind an edge is bent
/// sideways.
pub fn touching<'a>(
    finger: &'a FingerReadings<'_>,
    touch_force: f64,
) -> impl Iterator<Item = (usize, DVec3)> + 'a {
    // Compare squares, because there are many elements and few of them touch.
    let least = touch_force * touch_force;
    let forces = finger.touch.frame.forces.iter().enumerate();
    let touching = forces.filter(move |(_, force)| force.length_squared() > least);
    touching.map(|(element, _)| (element, finger.force(element)))
}
