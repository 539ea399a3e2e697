//! Where a finger touches.

use crate::control::sense::FingerSense;
use glam::DVec3;

/// The elements with a larger force on them than `touch_force` (N), and that force, N, in W.
///
/// Not only compression counts: a feeler that is caught behind an edge is bent sideways.
pub fn touching<'a>(
    finger: &'a FingerSense<'_>,
    touch_force: f64,
) -> impl Iterator<Item = (usize, DVec3)> + 'a {
    // Squares, for there are many elements and few that touch.
    let least = touch_force * touch_force;
    let forces = finger.touch.frame.forces.iter().enumerate();
    let touching = forces.filter(move |(_, force)| force.length_squared() > least);
    touching.map(|(element, _)| (element, finger.force(element)))
}
