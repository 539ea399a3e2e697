//! Wire format of [`Joints`] and [`Command`] for fingers that do not have three joints.

use super::channels::{Command, Joints, stamped};
use crate::wire::Vector3;
use crate::{message, vector3_schema};
use feeler::hand::{JointVector, MAX_JOINTS};
use serde::{Deserialize, Serialize};

/// Encoder readings of one finger with any number of joints.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ChainJoints {
    /// Time of the reading (s).
    pub stamp: f64,
    /// Joint positions (rad or m).
    pub position: Vec<f64>,
    /// Joint velocities (rad/s or m/s).
    pub velocity: Vec<f64>,
}

message!(
    ChainJoints,
    "ChainJoints",
    "# Encoders of one finger with any number of joints",
    "float64 stamp  # s",
    "float64[] position  # rad or m",
    "float64[] velocity  # rad/s or m/s",
);

/// Command to the drives of one finger with any number of joints.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ChainCommand {
    /// Time of the command (s).
    pub stamp: f64,
    /// Joint velocities sent to the drives (rad/s or m/s).
    pub joint_velocity: Vec<f64>,
    /// Requested fingertip velocity before limiting, in `W` (m/s).
    pub fingertip_velocity: Vector3,
    /// `true` if a limit changed the request.
    pub limited: bool,
    /// Damping of the inverse kinematics near a singularity (m/rad); otherwise 0.
    pub damping: f64,
}

message!(
    ChainCommand,
    "ChainCommand",
    "# Command to the drives of one finger with any number of joints",
    "float64 stamp  # s",
    "float64[] joint_velocity  # rad/s or m/s, as sent",
    "geometry_msgs/Vector3 fingertip_velocity  # m/s in the world frame, as requested",
    "bool limited  # a limit changed the request",
    "float64 damping  # of the inverse near a singularity; 0 away from it",
    vector3_schema!(),
);

stamped!(ChainJoints, ChainCommand);

/// Converts recorded joint values to a vector.
fn joints(values: &[f64]) -> Result<JointVector, String> {
    let known = JointVector::from_slice(values);
    known.ok_or_else(|| format!("expected at most {MAX_JOINTS} joints, got {}", values.len()))
}

impl TryFrom<ChainJoints> for Joints {
    type Error = String;

    fn try_from(message: ChainJoints) -> Result<Self, String> {
        Ok(Self {
            stamp: message.stamp,
            position: joints(&message.position)?,
            velocity: joints(&message.velocity)?,
        })
    }
}

impl TryFrom<ChainCommand> for Command {
    type Error = String;

    fn try_from(message: ChainCommand) -> Result<Self, String> {
        Ok(Self {
            stamp: message.stamp,
            joint_velocity: joints(&message.joint_velocity)?,
            fingertip_velocity: message.fingertip_velocity,
            limited: message.limited,
            damping: message.damping,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::cdr;

    fn encoded<M: crate::wire::Message>(message: &M) -> Vec<u8> {
        let mut bytes = Vec::new();
        cdr::encode(message, &mut bytes).unwrap();
        bytes
    }

    fn joints(position: JointVector) -> Joints {
        Joints {
            stamp: 0.5,
            position,
            velocity: -1.0 * position,
        }
    }

    #[test]
    fn three_joints_are_an_array_and_others_a_list() {
        let three = encoded(&joints([0.1, -0.2, 0.3].into()));
        // The header of CDR, a stamp and six numbers.
        assert_eq!(three.len(), 4 + 7 * 8);
        assert_eq!(
            cdr::decode::<Joints>(&three).unwrap(),
            joints([0.1, -0.2, 0.3].into())
        );
        for count in [1, 2, 4, 7] {
            let own = joints(JointVector::splat(count, 0.25));
            let bytes = encoded(&own);
            let listed = ChainJoints {
                stamp: 0.5,
                position: vec![0.25; count],
                velocity: vec![-0.25; count],
            };
            assert_eq!(bytes, encoded(&listed));
        }
    }

    #[test]
    fn too_many_joints_are_refused() {
        assert!(
            super::joints(&[0.0; 8])
                .unwrap_err()
                .contains("at most 7 joints, got 8")
        );
    }
}
