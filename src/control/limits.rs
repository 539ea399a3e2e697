//! The only door to the hand: every command passes the finite check, the workspace, the joint limits,
//! the speed limits and the acceleration limit, in this order.

use crate::hand::finger::FingerGeometry;
use crate::hand::resolved_rate::resolved_rate;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What a command may ask of the hand, beside the joint limits of each finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitsConfig {
    /// Lowest corner of the box in which the domes' centres may be, m, in W.
    pub workspace_lower: [f64; 3],
    /// Highest corner of that box, m, in W.
    pub workspace_upper: [f64; 3],
    /// Greatest speed of a fingertip, m/s.
    pub fingertip_speed: f64,
    /// Greatest acceleration of a joint, rad/s².
    pub joint_acceleration: f64,
}

/// What is asked of one finger, and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Wanted velocity of the fingertip, m/s, in W.
    pub velocity: DVec3,
    /// Where the dome's centre is, m, in W.
    pub position: DVec3,
    /// Joint angles, rad.
    pub theta: DVec3,
    /// Joint velocities of the command before, rad/s.
    pub previous: DVec3,
}

/// What may be asked of one finger's drives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Admitted {
    /// Joint velocities, rad/s.
    pub joint_velocity: DVec3,
    /// Whether a limit changed what was asked.
    pub limited: bool,
    /// Damping of the inverse Jacobian near a singularity, m/rad; 0 elsewhere.
    pub damping: f64,
}

impl LimitsConfig {
    /// Turns a wanted fingertip velocity into joint velocities that stay within all limits over a
    /// control period of `period` seconds. `None` when the request or what becomes of it is not
    /// finite.
    pub fn admit(
        &self,
        geometry: &FingerGeometry,
        request: &Request,
        period: f64,
    ) -> Option<Admitted> {
        let numbers = [
            request.velocity,
            request.position,
            request.theta,
            request.previous,
        ];
        if !numbers.iter().all(|n| n.is_finite()) {
            return None;
        }
        let inside = self.keep_in_workspace(request.position, request.velocity, period);
        let slow = inside.clamp_length_max(self.fingertip_speed);
        let rate = resolved_rate(geometry, request.theta, slow);
        let stopped = keep_off_joint_limits(geometry, request.theta, rate.joint_velocity, period);
        let speed = scale_to(stopped, geometry.joint_speed_limit());
        let most_change = DVec3::splat(self.joint_acceleration * period);
        let joint_velocity = request.previous + scale_to(speed - request.previous, most_change);
        joint_velocity.is_finite().then_some(Admitted {
            joint_velocity,
            limited: slow != request.velocity || joint_velocity != rate.joint_velocity,
            damping: rate.damping,
        })
    }

    /// The velocity without the components that would lead out of the workspace.
    fn keep_in_workspace(&self, position: DVec3, velocity: DVec3, period: f64) -> DVec3 {
        let lower = DVec3::from_array(self.workspace_lower);
        let upper = DVec3::from_array(self.workspace_upper);
        without_leaving(position, velocity, (lower, upper), period)
    }
}

fn keep_off_joint_limits(
    geometry: &FingerGeometry,
    theta: DVec3,
    velocity: DVec3,
    period: f64,
) -> DVec3 {
    let limits = (geometry.joint_lower(), geometry.joint_upper());
    without_leaving(theta, velocity, limits, period)
}

/// `velocity` with each component zero that would take `position` further out of `limits` within
/// `period`.
fn without_leaving(
    position: DVec3,
    velocity: DVec3,
    (lower, upper): (DVec3, DVec3),
    period: f64,
) -> DVec3 {
    let next = position + period * velocity;
    let leaves = (next.cmplt(lower) & velocity.cmplt(DVec3::ZERO))
        | (next.cmpgt(upper) & velocity.cmpgt(DVec3::ZERO));
    DVec3::select(leaves, DVec3::ZERO, velocity)
}

/// `vector`, shortened without change of direction until no component exceeds that of `most`.
fn scale_to(vector: DVec3, most: DVec3) -> DVec3 {
    let excess = (vector.abs() / most).max_element();
    if excess > 1.0 {
        vector / excess
    } else {
        vector
    }
}
