//! Inverse kinematics of a chain: joint positions for a fingertip position, eq. (10) within the joint limits.
//!
//! The iteration starts from the given joint positions, so that a finger keeps its posture for a nearby target. A step
//! is the smallest joint motion of eq. (10), damped near singularities. Joints at a limit that would move outward are
//! fixed, and the result is clamped to the limits. A step that does not approach the target is halved, and if that does
//! not help, replaced by one along the gradient of the distance. If the iteration gets stuck, it restarts from the
//! middle of the joints' ranges and from a fixed sequence of positions that fills the ranges evenly. The solution found
//! that is nearest to the start is then returned.

use super::kinematics::State;
use super::solve::Task;
use super::task_rank::gram;
use super::{Chain, MAX_JOINTS};
use crate::hand::kinematics_error::{ChainKinematicsError, POSITION_TOLERANCE};
use glam::DVec3;

/// Residual at which the iteration stops (m). The rest of the tolerance is reserved for rounding errors.
const ITERATION_TOLERANCE: f64 = 0.5 * POSITION_TOLERANCE;

/// Maximum change of a joint in one step (rad, or a fraction of the reach).
const STEP_LIMIT: f64 = 0.5;

/// Maximum number of steps per start.
const STEPS: usize = 80;

/// Maximum number of halvings of a step that does not reduce the distance to the target.
const HALVINGS: usize = 10;

/// Number of restarts.
const RESTARTS: usize = 33;

/// State of the iteration.
struct Iterate {
    joints: [f64; MAX_JOINTS],
    /// Distance of the fingertip from the target (m).
    residual: f64,
}

impl Chain {
    /// Returns joint positions (rad or m, within the joint limits) that bring the fingertip within
    /// [`POSITION_TOLERANCE`] of `target` (in the world `W`, m), eq. (10).
    ///
    /// The iteration starts at `start` (rad or m), normally the current joint positions, clamped to the limits.
    ///
    /// # Errors
    /// If `target` is out of reach, if no solution within the joint limits is found, or if an argument is not finite.
    pub fn inverse_kinematics(
        &self,
        target: DVec3,
        start: &[f64],
    ) -> Result<[f64; MAX_JOINTS], ChainKinematicsError> {
        if !target.is_finite() || !self.is_finite(start) {
            let mut given = self.each(|_| f64::NAN);
            let own = given.iter_mut().take(self.joint_count());
            own.zip(start).for_each(|(own, &q)| *own = q);
            return Err(ChainKinematicsError::NotFinite {
                target,
                start: given,
                expected: self.joint_count(),
            });
        }
        let distance = target.distance(self.origin);
        if distance > self.reach + POSITION_TOLERANCE {
            return Err(ChainKinematicsError::OutOfReach {
                target,
                distance,
                maximum: self.reach,
            });
        }
        let start = self.clamped(start);
        let direct = self.iterate(target, start);
        if direct.residual <= POSITION_TOLERANCE {
            return Ok(direct.joints);
        }
        self.restart(target, &start, direct)
    }

    /// Iterates from all other start positions, and returns the solution nearest to `start`.
    fn restart(
        &self,
        target: DVec3,
        start: &[f64; MAX_JOINTS],
        direct: Iterate,
    ) -> Result<[f64; MAX_JOINTS], ChainKinematicsError> {
        let (mut best, mut nearest) = (direct, f64::INFINITY);
        for index in 0..RESTARTS {
            let end = self.iterate(target, self.sample(index));
            if end.residual <= POSITION_TOLERANCE {
                let distance = self.distance(start, &end.joints);
                if distance < nearest {
                    (best, nearest) = (end, distance);
                }
            } else if nearest.is_infinite() && end.residual < best.residual {
                best = end;
            }
        }
        if nearest.is_infinite() {
            return Err(ChainKinematicsError::NotConverged {
                target,
                residual: best.residual,
                joints: best.joints,
            });
        }
        Ok(best.joints)
    }

    /// Iterates from `start`, which must be within the limits.
    fn iterate(&self, target: DVec3, start: [f64; MAX_JOINTS]) -> Iterate {
        let mut joints = start;
        let mut state = State::at(self, &joints);
        let mut error = target - state.position(self);
        for _ in 0..STEPS {
            if error.length() <= ITERATION_TOLERANCE {
                break;
            }
            let columns = self.scaled(state.jacobian(self));
            let task = Task {
                columns: &columns,
                goal: error,
                pull: [0.0; MAX_JOINTS],
                bounds: self.outward_stops(&joints),
                // The damping vanishes even as a singular target is approached.
                most_damping: error.length(),
            };
            let step = self.solve_within_bounds(&task).velocity;
            let next = self.nearer(&joints, step, target, error.length());
            let next = next.or_else(|| {
                let step = gradient(&task);
                self.nearer(&joints, step, target, error.length())
            });
            let Some(next) = next else { break };
            (joints, state) = next;
            error = target - state.position(self);
        }
        Iterate {
            joints,
            residual: error.length(),
        }
    }

    /// Tries `step` (limited to [`STEP_LIMIT`]), a half of it, a quarter and so on. Returns the first joint positions
    /// with which the fingertip is nearer to `target` than `distance`; `None` if there are no such positions.
    fn nearer(
        &self,
        joints: &[f64; MAX_JOINTS],
        step: [f64; MAX_JOINTS],
        target: DVec3,
        distance: f64,
    ) -> Option<([f64; MAX_JOINTS], State)> {
        let largest = step
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        if largest == 0.0 {
            return None;
        }
        let mut share = (STEP_LIMIT / largest).min(1.0);
        for _ in 0..HALVINGS {
            let mut next = *joints;
            for ((q, joint), value) in next.iter_mut().zip(&self.joints).zip(step) {
                *q += share * joint.scale * value;
            }
            let next = self.clamped(&next);
            let state = State::at(self, &next);
            if state.position(self).distance(target) < distance {
                return Some((next, state));
            }
            share *= 0.5;
        }
        None
    }

    /// Clamps `joints` to the joint limits.
    fn clamped(&self, joints: &[f64]) -> [f64; MAX_JOINTS] {
        let mut clamped = [0.0; MAX_JOINTS];
        for ((value, joint), &q) in clamped.iter_mut().zip(&self.joints).zip(joints) {
            *value = q.clamp(joint.lower, joint.upper);
        }
        clamped
    }

    /// Distance between two sets of joint positions, in scaled units.
    fn distance(&self, a: &[f64; MAX_JOINTS], b: &[f64; MAX_JOINTS]) -> f64 {
        let differences = a.iter().zip(b).zip(&self.joints);
        let squares = differences.map(|((a, b), joint)| {
            let difference = (a - b) / joint.scale;
            difference * difference
        });
        squares.sum::<f64>().sqrt()
    }
}

/// Gradient-descent step on the distance, short enough to reduce it if the fingertip position were linear in the joints.
fn gradient(task: &Task) -> [f64; MAX_JOINTS] {
    let matrix = gram(task.columns, usize::MAX);
    let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    task.columns
        .map(|column| column.dot(task.goal) / trace.max(f64::MIN_POSITIVE))
}
