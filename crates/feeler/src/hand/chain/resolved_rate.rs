//! Resolved motion rate control of a chain: eq. (1) for any number of joints, damped near singularities, with redundant
//! joints moved towards the middle of their ranges.
//!
//! Joints that only move frames along their axes are scaled, so that all columns of `J` are in m/rad: one unit moves the
//! fastest frame by the chain's reach. r is the number of directions in which the joints can move the fingertip, at most
//! 3, and sigma the r-th singular value of `J`. The joint velocity is
//!
//! ```text
//! q_dot = J^T (J J^T + lambda^2 I)^-1 v + min(1, sigma^2 / epsilon^2) N z
//! lambda^2 = max(0, epsilon^2 - sigma^2)
//! z_j = -k |v| / reach (h / h_j) d_j,    d_j = (q_j - middle_j) / h_j
//! ```
//!
//! in the span of the first r singular vectors. The first term is the damped least-squares solution (Y. Nakamura and
//! H. Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator control", ASME J. Dyn.
//! Sys. Meas. Control 108, 1986). It gives the nearest possible fingertip velocity if the joints cannot move in all
//! directions, for example if there are fewer than three.
//!
//! The second term is the projected negative gradient of `sum d_j^2` (A. Liegeois, "Automatic supervisory control of
//! the configuration and behavior of multibody mechanisms", IEEE Trans. Syst. Man Cybern. 7, 1977). h_j is half of the
//! range of joint j, h the smallest one, and N projects on the joint velocities that do not move the fingertip. As z is
//! proportional to the speed |v|, a finger at rest stays at rest: self-motion would roll the fingertip on the object.
//! The factor reduces the self-motion to zero at singularities, where N is discontinuous.
//!
//! A direction with singular value `s >= sigma` is amplified by at most `1 / epsilon`, and N does not lengthen z. So
//! `|q_dot| <= |v| (1 / epsilon + k sqrt(n) / reach)` everywhere, in scaled units, even if joints are stopped at their
//! limits. With other bounds, v includes the fingertip velocity of the joints at their bounds.
//!
//! If joint velocities exceed their bounds, the one that exceeds them most is fixed at its bound and the rest solved again
//! for the remaining fingertip velocity, so that the other joints take over if possible (F. Flacco, A. De Luca and O.
//! Khatib, "Motion control of redundant robots under joint constraints: saturation in the null space", ICRA 2012).
//! Without given bounds, a joint at a limit must not move outward.

use super::solve::{Bounds, Task};
use super::{Chain, MAX_JOINTS};
use glam::DVec3;

/// Gain k: speed of the self-motion (joint motion that does not move the fingertip) relative to that of the task.
const SELF_MOTION: f64 = 0.5;

/// Distance from a limit at which a joint counts as at the limit (rad or m).
const LIMIT_TOLERANCE: f64 = 1e-9;

/// Joint velocities for a fingertip velocity, with the damping that was applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainRate {
    /// Velocities of the joints (rad/s or m/s), not limited to the joints' speeds.
    pub joint_velocity: [f64; MAX_JOINTS],
    /// Damping lambda (m/rad): 0 away from singularities, [`Chain::damping_threshold`] at a singularity.
    pub damping: f64,
    /// `true` for each joint whose velocity is at its bound.
    pub bounded: [bool; MAX_JOINTS],
}

impl Chain {
    /// Threshold epsilon (m/rad): damping starts when the smallest singular value falls below it, in scaled units.
    /// Singular values that are 0 in all postures do not count.
    pub fn damping_threshold(&self) -> f64 {
        self.damping_threshold
    }

    /// Returns the joint velocity that moves the fingertip at `fingertip_velocity` (in the world `W`, m/s) at `joints`
    /// (rad or m), eq. (1). Joints at a limit do not move outward.
    ///
    /// Finite arguments give a finite result, even at a singularity; a result beyond the range of `f64` saturates at
    /// the largest finite value. A NaN or infinity in an argument makes the result NaN.
    pub fn resolved_rate(&self, joints: &[f64], fingertip_velocity: DVec3) -> ChainRate {
        self.resolved_rate_within(joints, fingertip_velocity, &self.outward_stops(joints))
    }

    /// Like [`resolved_rate`](Self::resolved_rate), but within `bounds`, the lowest and highest velocity of each joint
    /// (rad/s or m/s), regardless of the limits. A lowest velocity above 0, a highest velocity below 0 and NaN count as
    /// 0.
    ///
    /// With bounds that decrease towards the limits, the other joints take over before a joint has to stop.
    pub fn resolved_rate_within(
        &self,
        joints: &[f64],
        fingertip_velocity: DVec3,
        bounds: &[[f64; 2]; MAX_JOINTS],
    ) -> ChainRate {
        if !self.is_finite(joints) || !fingertip_velocity.is_finite() {
            return ChainRate {
                joint_velocity: self.each(|_| f64::NAN),
                damping: f64::NAN,
                bounded: [false; MAX_JOINTS],
            };
        }
        let columns = self.scaled_jacobian(joints);
        // Solved for a velocity of magnitude 1, so that no intermediate product can overflow.
        let magnitude = fingertip_velocity
            .abs()
            .max_element()
            .max(f64::MIN_POSITIVE);
        let goal = fingertip_velocity / magnitude;
        let mut scaled_bounds = [[0.0; 2]; MAX_JOINTS];
        for (index, joint) in self.joints.iter().enumerate() {
            let [lowest, highest] = around_zero(bounds[index]);
            scaled_bounds[index] = [lowest, highest].map(|bound| bound / joint.scale / magnitude);
        }
        let solution = self.solve_within_bounds(&Task {
            columns: &columns,
            goal,
            pull: self.pull(joints, goal.length()),
            bounds: scaled_bounds,
            most_damping: f64::INFINITY,
        });
        let mut rate = ChainRate {
            joint_velocity: [0.0; MAX_JOINTS],
            damping: solution.damping,
            bounded: [false; MAX_JOINTS],
        };
        for (index, joint) in self.joints.iter().enumerate() {
            let velocity = solution.velocity[index] * joint.scale * magnitude;
            let [lowest, highest] = around_zero(bounds[index]);
            // Also removes the rounding of bounds that are subnormal in scaled units.
            rate.joint_velocity[index] = velocity.clamp(lowest, highest);
            rate.bounded[index] = solution.free & (1 << index) == 0;
        }
        rate
    }

    /// Velocity bounds that prevent joints at a limit from moving outward.
    #[inline]
    pub(super) fn outward_stops(&self, joints: &[f64]) -> Bounds {
        let mut bounds = [[0.0; 2]; MAX_JOINTS];
        for ((bounds, joint), &q) in bounds.iter_mut().zip(&self.joints).zip(joints) {
            if q > joint.lower + LIMIT_TOLERANCE {
                bounds[0] = f64::NEG_INFINITY;
            }
            if q < joint.upper - LIMIT_TOLERANCE {
                bounds[1] = f64::INFINITY;
            }
        }
        bounds
    }

    /// `true` if `joints` has a finite value for each joint.
    pub(super) fn is_finite(&self, joints: &[f64]) -> bool {
        let own = joints.get(..self.joint_count());
        own.is_some_and(|own| own.iter().all(|q| q.is_finite()))
    }

    /// Desired self-motion z, if the fingertip moves at `speed` (m/s), in scaled units.
    fn pull(&self, joints: &[f64], speed: f64) -> [f64; MAX_JOINTS] {
        let mut pull = [0.0; MAX_JOINTS];
        if self.joint_count() == 1 {
            return pull;
        }
        let halves = self
            .joints
            .iter()
            .map(|joint| joint.half_range() / joint.scale);
        let smallest = halves.fold(f64::INFINITY, f64::min);
        let strength = SELF_MOTION * speed / self.reach;
        for ((z, joint), q) in pull.iter_mut().zip(&self.joints).zip(joints) {
            let half = joint.half_range();
            let deviation = ((q - joint.middle()) / half).clamp(-1.0, 1.0);
            *z = -strength * smallest * joint.scale / half * deviation;
        }
        pull
    }
}

/// Extends bounds to include 0 and be finite. NaN counts as 0.
fn around_zero(bounds: [f64; 2]) -> [f64; 2] {
    let [lowest, highest] = bounds.map(|bound| if bound.is_nan() { 0.0 } else { bound });
    [lowest.clamp(f64::MIN, 0.0), highest.clamp(0.0, f64::MAX)]
}
