//! `geometry_msgs/WrenchStamped`.

use super::header::{Header, header_schema, nested, xyz_schema};
use crate::wire::{Message, Vector3};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A force and a torque.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force (N).
    pub force: Vector3,
    /// Torque about the frame's origin (N m).
    pub torque: Vector3,
}

impl Wrench {
    /// Sums `forces` (N), given with their positions (m), and their torques about the origin.
    pub fn of(forces: impl Iterator<Item = (DVec3, DVec3)>) -> Self {
        let (mut sum, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for (position, force) in forces {
            sum += force;
            torque += position.cross(force);
        }
        Self {
            force: sum.into(),
            torque: torque.into(),
        }
    }
}

/// Wrench on a fingertip by everything that its elements touch, in the dome's frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// Time of the image from which the forces were computed, and the dome's frame.
    pub header: Header,
    /// Wrench on the fingertip.
    pub wrench: Wrench,
}

impl Message for WrenchStamped {
    const SCHEMA_NAME: &'static str = "geometry_msgs/msg/WrenchStamped";
    const SCHEMA: &'static str = concat!(
        "std_msgs/Header header\n",
        "Wrench wrench\n",
        header_schema!(),
        nested!("geometry_msgs/Wrench", "Vector3 force", "Vector3 torque"),
        xyz_schema!("geometry_msgs/Vector3"),
    );
}
