//! Conversion from and to `geometry_msgs/WrenchStamped`.

use super::ArrayError;
use super::message::{TactileArray, TactileChannel};
use crate::ros::{Wrench, WrenchStamped};
use crate::wire::{Quaternion, Vector3};
use glam::DVec3;

/// Sums the valid forces of an array, with their torque about the origin of the header's frame. The distribution over
/// the elements and everything else but time and frame are lost.
///
/// # Errors
/// If the array is invalid or has no forces in newtons.
pub fn to_wrench(array: &TactileArray) -> Result<WrenchStamped, ArrayError> {
    let forces = array.forces()?;
    let positions = array
        .positions
        .iter()
        .map(|&position| DVec3::from(position));
    let known = positions.zip(forces).filter(|(_, force)| force.is_finite());
    Ok(WrenchStamped {
        header: array.header.clone(),
        wrench: Wrench::of(known),
    })
}

/// Creates an array of one element at the origin of the wrench's frame, whose z axis is the outward normal. The torque is
/// lost; all other properties are unknown.
pub fn from_wrench(wrench: &WrenchStamped) -> TactileArray {
    let Vector3 { x, y, z } = wrench.wrench.force;
    TactileArray {
        positions: vec![Vector3::default()],
        orientations: vec![Quaternion::default()],
        channels: vec![TactileChannel {
            values: vec![x, y, z],
            ..TactileChannel::of_forces()
        }],
        ..TactileArray::unknown(&wrench.header)
    }
}
