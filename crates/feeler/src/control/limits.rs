//! Single path of all motion commands: every command passes the check for finite values, the workspace, the speed limit
//! of the fingertip, the joint limits, the joint speed limits and the acceleration limit, in this order.
//!
//! Stop commands bypass it: they stop all drives at once, as fast as the drives brake, regardless of the acceleration
//! limit.

use crate::check::Checker;
use crate::hand::geometry::FingerGeometry;
use crate::hand::joint_vector::{JointVector, greater, lesser};
use crate::hand::kinematics::{damping_threshold, resolved_rate_within};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Limits of all motion commands, in addition to the joint limits of each finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsConfig {
    /// Lower corner of the workspace, the box in which the domes' centres must stay (m, in W).
    pub workspace_lower: [f64; 3],
    /// Upper corner of the workspace (m, in W).
    pub workspace_upper: [f64; 3],
    /// Maximum speed of a fingertip (m/s).
    pub fingertip_speed: f64,
    /// Maximum acceleration of a joint (rad/s²).
    pub joint_acceleration: f64,
    /// Compression of an element above which the hand stops without resuming (N), as a guard against unforeseen
    /// failures. `None` disables the check.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element_force: Option<f64>,
}

impl Default for LimitsConfig {
    /// Values of the reference experiment: a box around its cap.
    fn default() -> Self {
        Self {
            workspace_lower: [-0.06, -0.03, 0.07],
            workspace_upper: [0.06, 0.03, 0.13],
            fingertip_speed: 0.05,
            joint_acceleration: 20.0,
            element_force: None,
        }
    }
}

/// Requested velocity and current state of one finger, before limiting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Requested velocity of the fingertip (m/s, in W).
    pub velocity: DVec3,
    /// Position of the dome's centre (m, in W).
    pub position: DVec3,
    /// Joint angles (rad).
    pub theta: JointVector,
    /// Joint velocities of the previous command (rad/s).
    pub previous: JointVector,
}

/// Joint velocities of one finger after limiting.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LimitedCommand {
    /// Joint velocities (rad/s).
    pub joint_velocity: JointVector,
    /// `true` if a limit changed the request.
    pub limited: bool,
    /// Damping of the inverse Jacobian (m/rad), nonzero only near a singularity.
    pub damping: f64,
}

impl LimitsConfig {
    /// Checks that every value of the table `key` is in its range. `over_force` is F2 (N), the largest force in normal
    /// operation.
    pub fn check(&self, key: &str, over_force: f64, checker: &mut Checker) {
        let positive = [
            ("fingertip_speed", self.fingertip_speed),
            ("joint_acceleration", self.joint_acceleration),
        ];
        checker.all_positive(key, &positive);
        if let Some(limit) = self.element_force {
            checker.require(
                &format!("{key}.element_force"),
                limit.to_string(),
                limit.is_finite() && limit > over_force,
                &format!("more than control.over_force = {over_force}"),
            );
        }
        let (lower, upper) = (self.workspace_lower, self.workspace_upper);
        checker.vector(&format!("{key}.workspace_lower"), lower);
        checker.require(
            &format!("{key}.workspace_upper"),
            format!("{upper:?}"),
            upper.iter().zip(lower).all(|(&u, l)| u <= 10.0 && u > l),
            &format!("more than {key}.workspace_lower = {lower:?}, at most 10"),
        );
    }

    /// Converts a requested fingertip velocity to joint velocities for a control period of `period` seconds, such that
    /// the finger can always brake before a limit. Returns `None` if the request or the result is not finite.
    pub fn apply_limits(
        &self,
        geometry: &FingerGeometry,
        request: &Request,
        period: f64,
    ) -> Option<LimitedCommand> {
        let of_fingertip = request.velocity.is_finite() && request.position.is_finite();
        let of_joints = request.theta.is_finite() && request.previous.is_finite();
        if !(of_fingertip && of_joints) {
            return None;
        }
        let inside = self.keep_in_workspace(geometry, request, period);
        let slow = inside.clamp_length_max(self.fingertip_speed);
        let braking = Braking {
            deceleration: self.joint_acceleration,
            period,
        };
        let (lower, upper) = (geometry.joint_lower(), geometry.joint_upper());
        let bounds = |joint| braking.bounds(request.theta[joint], (lower[joint], upper[joint]));
        let rate = resolved_rate_within(geometry, request.theta, slow, Some(&bounds));
        let joint_velocity = match geometry.joint_count() {
            // A constant, so that the loops are unrolled.
            3 => self.limit_joints(3, geometry, &rate.joint_velocity, request, period, bounds),
            count => self.limit_joints(
                count,
                geometry,
                &rate.joint_velocity,
                request,
                period,
                bounds,
            ),
        };
        joint_velocity.is_finite().then_some(LimitedCommand {
            joint_velocity,
            limited: slow != request.velocity || joint_velocity != rate.joint_velocity,
            damping: rate.damping,
        })
    }

    /// Clamps the velocities of the first `count` joints to `bounds`, scales them down to the speed limits, and limits
    /// their change per period.
    #[inline(always)]
    fn limit_joints(
        &self,
        count: usize,
        geometry: &FingerGeometry,
        velocity: &JointVector,
        request: &Request,
        period: f64,
        bounds: impl Fn(usize) -> [f64; 2],
    ) -> JointVector {
        let most = geometry.joint_speed_limit();
        let mut within = JointVector::zeros(count);
        let mut excess = 1.0;
        for joint in 0..count {
            within[joint] = clamp(velocity[joint], bounds(joint));
            excess = greater(within[joint].abs() / most[joint], excess);
        }
        // Per joint: a joint that must brake must not wait for another one that may accelerate.
        let most_change = self.joint_acceleration * period;
        for joint in 0..count {
            // Scaled down, keeping the direction.
            let speed = if excess > 1.0 {
                within[joint] / excess
            } else {
                within[joint]
            };
            let previous = request.previous[joint];
            let change = clamp(speed - previous, [-most_change, most_change]);
            within[joint] = previous + change;
        }
        within
    }

    /// Reduces the requested velocity near the boundary of the workspace.
    ///
    /// The assumed braking deceleration of the fingertip is the one at the threshold of singularity damping; elsewhere
    /// the finger could brake harder. Even closer to a singularity, where the inverse Jacobian is damped, the fingertip
    /// does not follow its velocity exactly and may leave the workspace slightly.
    fn keep_in_workspace(
        &self,
        geometry: &FingerGeometry,
        request: &Request,
        period: f64,
    ) -> DVec3 {
        let braking = Braking {
            deceleration: self.joint_acceleration * damping_threshold(geometry),
            period,
        };
        DVec3::from_array([0, 1, 2].map(|axis| {
            let limits = (self.workspace_lower[axis], self.workspace_upper[axis]);
            let bounds = braking.bounds(request.position[axis], limits);
            clamp(request.velocity[axis], bounds)
        }))
    }
}

/// Clamps `value` to `lowest`..`highest`. NaN becomes `lowest`.
#[inline(always)]
fn clamp(value: f64, [lowest, highest]: [f64; 2]) -> f64 {
    lesser(greater(value, lowest), highest)
}

/// Braking model of a quantity whose velocity is commanded once per period.
struct Braking {
    /// Maximum deceleration, in units of the quantity per s².
    deceleration: f64,
    /// Control period (s).
    period: f64,
}

impl Braking {
    /// Lowest and highest velocity from which braking ends within the limits `lower` and `upper` of `position`. Outside
    /// the limits, only motion back towards them is allowed.
    #[inline(always)]
    fn bounds(&self, position: f64, (lower, upper): (f64, f64)) -> [f64; 2] {
        let down = self.greatest_speed(position - lower);
        [-down, self.greatest_speed(upper - position)]
    }

    /// Maximum speed from which a stop within the distance `room` is possible: either in one period, if the
    /// deceleration allows that, or by `bT` each period, which from speed v covers at most `(v + bT/2)² / 2b`.
    fn greatest_speed(&self, room: f64) -> f64 {
        let (room, most_change) = (room.max(0.0), self.deceleration * self.period);
        let at_once = (room / self.period).min(most_change);
        let in_steps = (2.0 * self.deceleration * room).sqrt() - 0.5 * most_change;
        at_once.max(in_steps)
    }
}
