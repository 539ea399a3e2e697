//! Finger geometry, kinematics and the interface to the drives.
//!
//! A finger has one to seven joints. [`chain`] describes any arrangement of them. The paper's finger (section III) has
//! three joints, whose equations are in closed form. Joint 1 turns the finger's plane about the z axis of the base `B`.
//! Joints 2 and 3 move links l3 and l4 in that plane, starting at a distance l2 from the axis of joint 1. Angles are in
//! rad, lengths in m; positions and velocities of the fingertip are in the world `W`.
//!
//! With `c2 = cos(theta2)`, `s23 = sin(theta2 + theta3)` and so on, and a1, a2, a3 the columns of a:
//!
//! ```text
//! a = Ry(phi1) Rx(phi2) Rz(theta1)                                                       (3)
//! R = a [ c23 -s23  0 ]
//!       [  0    0  -1 ]                                                                  (3)
//!       [ s23  c23  0 ]
//! r = base + a1 (l2 + l3 c2 + l4 c23) + a3 (l3 s2 + l4 s23)
//! J = dr/dtheta = [ -R3 (l2 + l3 c2 + l4 c23) | l3 (R1 s3 + R2 c3) + l4 R2 | l4 R2 ]     (2)
//! theta_dot = J^-1 r_dot                                                                 (1)
//! theta <- theta + J^-1 (r_d - r)                                                       (10)
//! ```
//!
//! r is the origin of the fingertip frame `T`, the dome's centre; R transforms vectors from `T` to `W`. The x axis of
//! `T` (R1) points along the last link, which is the dome's outward axis. The y axis (R2) lies in the finger's plane,
//! in the direction of growing theta2 and theta3. The z axis (R3) is normal to that plane; theta1 moves the fingertip
//! along -R3. The paper misprints the matrix a of eq. (3) and the sign of eq. (10); this code uses the corrected
//! forms.
//!
//! `J` is singular if the finger is straight or folded (`sin(theta3) = 0`), or if its tip is on the axis of joint 1.

pub mod chain;
pub(crate) mod description;
pub(crate) mod finger;
pub(crate) mod geometry;
pub(crate) mod interface;
pub(crate) mod joint_vector;
pub mod kinematics;
pub(crate) mod kinematics_error;
pub(crate) mod leash;
pub(crate) mod sin_cos;
pub(crate) mod three_joints;

pub use description::FingerDescription;
pub use finger::{FingerConfig, FingerError};
pub use geometry::{FingerGeometry, FrameLimits, Kinematics};
pub use joint_vector::{JointVector, MAX_JOINTS};
pub use kinematics::{
    Jacobian, ResolvedRate, damping_threshold, fingertip_pose, inverse_kinematics, jacobian,
    resolved_rate,
};
pub use kinematics_error::{KinematicsError, POSITION_TOLERANCE};
pub use leash::LeashedGoal;
pub use sin_cos::sin_cos_of;
pub use three_joints::ThreeJoints;

pub use interface::{
    Hand, HandCommand, HandError, HandState, JointCoupling, JointEfforts, JointState, MAX_FINGERS,
    check_finger_count,
};
