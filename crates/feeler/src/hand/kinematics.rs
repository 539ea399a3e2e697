//! Pose, Jacobian, resolved rate and inverse kinematics of a finger, eqs. (1) to (3) and (10).

use super::geometry::{FingerGeometry, Kinematics};
use super::joint_vector::{JointVector, MAX_JOINTS};
use super::kinematics_error::KinematicsError;
use glam::{DMat3, DVec3};
use std::ops::Mul;

/// Returns the fingertip pose at the joint positions `theta` (rad or m).
///
/// The position `r` is the dome's centre, the origin of the fingertip frame `T`, in the world `W` (m). The rotation
/// `R` of eq. (3) transforms vectors from `T` to `W`. Its first column, the x axis of `T`, is the dome's outward axis.
#[inline(always)]
pub fn fingertip_pose(geometry: &FingerGeometry, theta: JointVector) -> (DVec3, DMat3) {
    match geometry.kinematics() {
        Kinematics::ThreeJoints(finger) => finger.pose(three(theta)),
        Kinematics::Chain(chain) => chain.pose(theta.padded(chain.joint_count()).as_slice()),
    }
}

/// Jacobian of a finger. Column i is the fingertip velocity in `W` per unit velocity of joint i (m/rad or m/m).
///
/// The product with joint velocities (rad/s or m/s) is the fingertip velocity (m/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobian {
    columns: [DVec3; MAX_JOINTS],
    joints: usize,
}

impl Jacobian {
    /// Columns of the Jacobian, one per joint.
    pub fn columns(&self) -> &[DVec3] {
        &self.columns[..self.joints]
    }
}

impl Mul<JointVector> for Jacobian {
    type Output = DVec3;

    fn mul(self, joint_velocity: JointVector) -> DVec3 {
        let columns = self.columns().iter().zip(joint_velocity.iter());
        let sum = columns.map(|(column, velocity)| *column * velocity);
        sum.reduce(|sum, velocity| sum + velocity)
            .unwrap_or(DVec3::ZERO)
    }
}

/// Returns the Jacobian of eq. (2) at the joint positions `theta` (rad or m): `r_dot = J theta_dot`.
pub fn jacobian(geometry: &FingerGeometry, theta: JointVector) -> Jacobian {
    let mut columns = [DVec3::ZERO; MAX_JOINTS];
    match geometry.kinematics() {
        Kinematics::ThreeJoints(finger) => {
            let own = finger.jacobian(three(theta));
            columns[..3].copy_from_slice(&[own.x_axis, own.y_axis, own.z_axis]);
        }
        Kinematics::Chain(chain) => {
            columns = chain.jacobian(theta.padded(chain.joint_count()).as_slice());
        }
    }
    Jacobian {
        columns,
        joints: geometry.joint_count(),
    }
}

/// Joint velocities for a fingertip velocity, with the damping that was applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResolvedRate {
    /// Joint velocities (rad/s or m/s), not limited to the finger's joint speeds.
    pub joint_velocity: JointVector,
    /// Damping lambda (m/rad): 0 if eq. (1) holds exactly, [`damping_threshold`] at a singularity.
    pub damping: f64,
}

/// Returns the joint velocity that moves the fingertip at `fingertip_velocity` (in the world `W`, m/s) at the joint
/// positions `theta` (rad or m), eq. (1).
///
/// Near a singularity it is damped. Redundant joints of a chain move towards the middle of their ranges while the
/// fingertip moves; see [`Chain::resolved_rate`](super::chain::Chain::resolved_rate).
///
/// Finite arguments give a finite result, even at a singularity; a result beyond the range of `f64` saturates at the
/// largest finite value. A NaN or infinity in an argument makes the result NaN.
pub fn resolved_rate(
    geometry: &FingerGeometry,
    theta: JointVector,
    fingertip_velocity: DVec3,
) -> ResolvedRate {
    resolved_rate_within(geometry, theta, fingertip_velocity, None)
}

/// Like [`resolved_rate`], but the joint velocities of a chain stay within `bounds`; if a joint reaches its bound, the
/// others compensate. `bounds` returns the lowest and highest velocity of a joint (rad/s or m/s). It has no effect on a
/// finger with three joints in closed form.
pub(crate) fn resolved_rate_within(
    geometry: &FingerGeometry,
    theta: JointVector,
    fingertip_velocity: DVec3,
    bounds: Option<&dyn Fn(usize) -> [f64; 2]>,
) -> ResolvedRate {
    match geometry.kinematics() {
        Kinematics::ThreeJoints(finger) => {
            let (velocity, damping) = finger.resolved_rate(three(theta), fingertip_velocity);
            ResolvedRate {
                joint_velocity: velocity.to_array().into(),
                damping,
            }
        }
        Kinematics::Chain(chain) => {
            let theta = theta.padded(chain.joint_count());
            let joints = theta.as_slice();
            let rate = match bounds {
                None => chain.resolved_rate(joints, fingertip_velocity),
                Some(bounds) => {
                    let mut all = [[0.0; 2]; MAX_JOINTS];
                    let own = all.iter_mut().enumerate().take(chain.joint_count());
                    own.for_each(|(joint, own)| *own = bounds(joint));
                    chain.resolved_rate_within(joints, fingertip_velocity, &all)
                }
            };
            ResolvedRate {
                joint_velocity: JointVector::first(rate.joint_velocity, chain.joint_count()),
                damping: rate.damping,
            }
        }
    }
}

/// Threshold epsilon (m/rad): damping starts when the smallest singular value of the Jacobian falls below it.
pub fn damping_threshold(geometry: &FingerGeometry) -> f64 {
    match geometry.kinematics() {
        Kinematics::ThreeJoints(finger) => finger.damping_threshold(),
        Kinematics::Chain(chain) => chain.damping_threshold(),
    }
}

/// Returns joint positions (rad or m, within the joint limits) that bring the fingertip within
/// [`POSITION_TOLERANCE`](super::POSITION_TOLERANCE) of `target` (in the world `W`, m), eq. (10).
///
/// The iteration starts at `start` (rad or m), normally the current joint positions. They may be outside the joint
/// limits.
///
/// # Errors
/// If `target` is out of reach, if no solution is within the joint limits, or if an argument is not finite.
pub fn inverse_kinematics(
    geometry: &FingerGeometry,
    target: DVec3,
    start: JointVector,
) -> Result<JointVector, KinematicsError> {
    match geometry.kinematics() {
        Kinematics::ThreeJoints(finger) => {
            let theta = finger.inverse_kinematics(target, three(start))?;
            Ok(theta.to_array().into())
        }
        Kinematics::Chain(chain) => {
            let start = start.padded(chain.joint_count());
            let found = chain.inverse_kinematics(target, start.as_slice())?;
            Ok(JointVector::first(found, chain.joint_count()))
        }
    }
}

/// Positions theta1..theta3 of the three joints of the paper's finger.
#[inline(always)]
fn three(joints: JointVector) -> DVec3 {
    DVec3::new(joints[0], joints[1], joints[2])
}
