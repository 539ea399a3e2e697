//! The only door to the hand: every command that moves it passes the finite check, the workspace, the
//! joint limits, the speed limits and the acceleration limit, in this order.
//!
//! A command to stop does not: it is for all drives at once, as fast as they brake, whatever the
//! acceleration limit.

use crate::check::Checker;
use crate::hand::finger::FingerGeometry;
use crate::hand::resolved_rate::{damping_threshold, resolved_rate};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What a command may ask of the hand, beside the joint limits of each finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsConfig {
    /// Lowest corner of the box in which the domes' centres may be, m, in W.
    pub workspace_lower: [f64; 3],
    /// Highest corner of that box, m, in W.
    pub workspace_upper: [f64; 3],
    /// Greatest speed of a fingertip, m/s.
    pub fingertip_speed: f64,
    /// Greatest acceleration of a joint, rad/s².
    pub joint_acceleration: f64,
    /// An element that is pressed harder than this stops the hand for good, N: something has gone wrong that no
    /// task foresaw. Without it, nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element_force: Option<f64>,
}

impl Default for LimitsConfig {
    /// The reference experiment's: a box about its cap.
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
    /// Requires every value of the table `key` to be in its range, where `over_force` (F2), N, is a usual force.
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

    /// Turns a wanted fingertip velocity into joint velocities for a control period of `period`
    /// seconds, from which the finger can always be braked before a limit. `None` when the request
    /// or what becomes of it is not finite.
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
        let inside = self.keep_in_workspace(geometry, request, period);
        let slow = inside.clamp_length_max(self.fingertip_speed);
        let rate = resolved_rate(geometry, request.theta, slow);
        let joint_limits = (geometry.joint_lower(), geometry.joint_upper());
        let braking = Braking {
            deceleration: self.joint_acceleration,
            period,
        };
        let within = braking.keep_within(request.theta, rate.joint_velocity, joint_limits);
        let speed = scale_to(within, geometry.joint_speed_limit());
        // Joint by joint: a joint that must brake must not wait for one that may speed up.
        let most_change = DVec3::splat(self.joint_acceleration * period);
        let change = (speed - request.previous).clamp(-most_change, most_change);
        let joint_velocity = request.previous + change;
        joint_velocity.is_finite().then_some(Admitted {
            joint_velocity,
            limited: slow != request.velocity || joint_velocity != rate.joint_velocity,
            damping: rate.damping,
        })
    }

    /// The velocity, slowed down where it leads to the workspace's end.
    ///
    /// A fingertip brakes as fast as the joint accelerations allow where the finger is closest to
    /// being singular; elsewhere it could brake harder. Closer still, where the inverse Jacobian is
    /// damped, it does not go quite where it is told, and may leave the workspace a little.
    fn keep_in_workspace(
        &self,
        geometry: &FingerGeometry,
        request: &Request,
        period: f64,
    ) -> DVec3 {
        let lower = DVec3::from_array(self.workspace_lower);
        let upper = DVec3::from_array(self.workspace_upper);
        let braking = Braking {
            deceleration: self.joint_acceleration * damping_threshold(geometry),
            period,
        };
        braking.keep_within(request.position, request.velocity, (lower, upper))
    }
}

/// How fast something that is commanded once per period can be stopped.
struct Braking {
    /// Greatest deceleration, per s².
    deceleration: f64,
    /// Time from one command to the next, s.
    period: f64,
}

impl Braking {
    /// `velocity`, each component slowed down until braking from it ends within `limits`. What is
    /// outside of them may only come back.
    fn keep_within(
        &self,
        position: DVec3,
        velocity: DVec3,
        (lower, upper): (DVec3, DVec3),
    ) -> DVec3 {
        let down = (position - lower).map(|room| self.greatest_speed(room));
        let up = (upper - position).map(|room| self.greatest_speed(room));
        velocity.max(-down).min(up)
    }

    /// Greatest speed that stops within `room`: at once, if that is within the deceleration; or
    /// slower by `bT` each period, which from speed v goes on for `(v + bT/2)² / 2b` at most.
    fn greatest_speed(&self, room: f64) -> f64 {
        let (room, most_change) = (room.max(0.0), self.deceleration * self.period);
        let at_once = (room / self.period).min(most_change);
        let in_steps = (2.0 * self.deceleration * room).sqrt() - 0.5 * most_change;
        at_once.max(in_steps)
    }
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
