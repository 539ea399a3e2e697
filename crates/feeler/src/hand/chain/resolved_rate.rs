//! Resolved motion rate control of a chain: eq. (1) for any number of joints, damped near singularities, with
//! redundant joints turned towards the middle of their ranges.
//!
//! Displacements are scaled by the chain's reach, so that all columns of `J` are in m/rad. r is the number of directions
//! in which the joints can move the fingertip, at most 3, and sigma the r-th singular value of `J`. The joint velocity
//! is
//!
//! ```text
//! q_dot = J^T (J J^T + lambda^2 I)^-1 v + min(1, sigma^2 / epsilon^2) N z
//! lambda^2 = max(0, epsilon^2 - sigma^2)
//! z_j = -k |v| / reach (h / h_j) d_j,    d_j = (q_j - middle_j) / h_j
//! ```
//!
//! in the span of the first r singular vectors. The first term is the damped least-squares solution (Y. Nakamura and
//! H. Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator control", ASME J. Dyn.
//! Sys. Meas. Control 108, 1986). It is the nearest possible fingertip velocity if the joints cannot move in all
//! directions, for example if there are fewer than three.
//!
//! The second term is the projected gradient of `sum d_j^2` (A. Liegeois, "Automatic supervisory control of the
//! configuration and behavior of multibody mechanisms", IEEE Trans. Syst. Man Cybern. 7, 1977). h_j is half of the range
//! of joint j, h the smallest one, and N projects on the joint velocities that do not move the fingertip. As z is
//! proportional to the speed |v|, a finger at rest stays at rest: self-motion would roll the fingertip on the object.
//! The factor fades the self-motion out at singularities, where N is discontinuous.
//!
//! A direction with singular value `s >= sigma` is amplified by at most `1 / epsilon`, and N does not lengthen z. So
//! `|q_dot| <= |v| (1 / epsilon + k sqrt(n) / reach)` everywhere, with scaled displacements.
//!
//! If a joint at a limit would move outward, the fastest of them is fixed and the rest solved again, so that the other
//! joints take over its part if possible.

use super::spectrum::Spectrum;
use super::task_rank::gram;
use super::{Chain, MAX_JOINTS};
use glam::{DMat3, DVec3};

/// k: speed of the self-motion relative to that of the task.
const SELF_MOTION: f64 = 0.5;

/// Distance from a limit at which a joint counts as at the limit (rad or m).
const LIMIT_TOLERANCE: f64 = 1e-9;

/// Joint velocity for a fingertip velocity, with the damping that was applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainRate {
    /// Velocities of the joints (rad/s or m/s), not limited to the joints' speeds.
    pub joint_velocity: [f64; MAX_JOINTS],
    /// lambda (m/rad): 0 away from singularities, [`Chain::damping_threshold`] at a singularity.
    pub damping: f64,
    /// `true` for each joint that is fixed because it is at a limit and would move outward.
    pub fixed: [bool; MAX_JOINTS],
}

/// A linear system to solve for joint velocities, in scaled units.
pub(super) struct Task<'a> {
    /// Scaled Jacobian.
    pub(super) columns: &'a [DVec3; MAX_JOINTS],
    /// Fingertip velocity or displacement.
    pub(super) goal: DVec3,
    /// z of the self-motion.
    pub(super) pull: [f64; MAX_JOINTS],
    /// Upper bound of lambda (m/rad).
    pub(super) most_damping: f64,
}

/// Solution of a [`Task`].
pub(super) struct Solution {
    pub(super) velocity: [f64; MAX_JOINTS],
    damping: f64,
    /// Subset of the joints that are not fixed, as in [`TaskRanks`](super::task_rank::TaskRanks).
    free: usize,
}

impl Chain {
    /// Threshold epsilon (m/rad): damping starts when the smallest singular value of the Jacobian falls below it.
    pub fn damping_threshold(&self) -> f64 {
        self.damping_threshold
    }

    /// Returns the joint velocity that moves the fingertip at `fingertip_velocity` (in the world `W`, m/s) at `joints`
    /// (rad or m), eq. (1).
    ///
    /// Finite arguments give a finite result, even at a singularity; a result beyond the range of `f64` saturates at
    /// the largest finite value. A NaN or infinity in an argument makes the result NaN.
    pub fn resolved_rate(&self, joints: &[f64], fingertip_velocity: DVec3) -> ChainRate {
        if !self.is_finite(joints) || !fingertip_velocity.is_finite() {
            return ChainRate {
                joint_velocity: self.each(|_| f64::NAN),
                damping: f64::NAN,
                fixed: [false; MAX_JOINTS],
            };
        }
        let columns = self.scaled_jacobian(joints);
        // Solved for a velocity of magnitude 1, so that no intermediate product can overflow.
        let magnitude = fingertip_velocity
            .abs()
            .max_element()
            .max(f64::MIN_POSITIVE);
        let goal = fingertip_velocity / magnitude;
        let solution = self.solve_within_limits(
            joints,
            &Task {
                columns: &columns,
                goal,
                pull: self.pull(joints, goal.length()),
                most_damping: f64::INFINITY,
            },
        );
        let mut rate = ChainRate {
            joint_velocity: [0.0; MAX_JOINTS],
            damping: solution.damping,
            fixed: [false; MAX_JOINTS],
        };
        for (index, joint) in self.joints.iter().enumerate() {
            let velocity = solution.velocity[index] * joint.scale * magnitude;
            rate.joint_velocity[index] = velocity.clamp(f64::MIN, f64::MAX);
            rate.fixed[index] = solution.free & (1 << index) == 0;
        }
        rate
    }

    /// `true` if `joints` has a finite entry per joint.
    pub(super) fn is_finite(&self, joints: &[f64]) -> bool {
        let own = joints.get(..self.joint_count());
        own.is_some_and(|own| own.iter().all(|q| q.is_finite()))
    }

    /// z of the self-motion for a fingertip `speed` (m/s), in scaled units.
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

    /// Solves `task`, and again with each joint fixed that is at a limit and would move outward.
    #[inline]
    pub(super) fn solve_within_limits(&self, joints: &[f64], task: &Task) -> Solution {
        let mut free = (1 << self.joint_count()) - 1;
        loop {
            let solution = self.solve(task, free);
            match self.fastest_outward(joints, &solution.velocity) {
                // A fixed joint does not move, so each pass fixes another one.
                Some(joint) => free &= !(1 << joint),
                None => return solution,
            }
        }
    }

    /// Joint with the highest outward velocity among those at a limit.
    #[inline]
    fn fastest_outward(&self, joints: &[f64], velocity: &[f64; MAX_JOINTS]) -> Option<usize> {
        let (mut fastest, mut speed) = (None, 0.0);
        for (index, (joint, &q)) in self.joints.iter().zip(joints).enumerate() {
            let v = velocity[index];
            let outward = v > 0.0 && q >= joint.upper - LIMIT_TOLERANCE
                || v < 0.0 && q <= joint.lower + LIMIT_TOLERANCE;
            if outward && v.abs() > speed {
                (fastest, speed) = (Some(index), v.abs());
            }
        }
        fastest
    }

    /// Solves `task` with the joints in `free`.
    #[inline]
    fn solve(&self, task: &Task, free: usize) -> Solution {
        let rank = self.ranks.rank(free);
        let gram = gram(task.columns, free);
        if rank == 3 && self.is_regular(&gram) {
            return regular(task, &gram, free);
        }
        self.near_singularity(task, &gram, free, rank)
    }

    /// `true` only if the smallest singular value exceeds epsilon: the product of the other two eigenvalues of `gram` is
    /// at most the square of half of their sum.
    #[inline]
    fn is_regular(&self, gram: &DMat3) -> bool {
        let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        let epsilon = self.damping_threshold;
        gram.determinant() >= 0.25 * trace * trace * epsilon * epsilon
    }

    /// Solution from the singular vectors, for any rank.
    fn near_singularity(&self, task: &Task, gram: &DMat3, free: usize, rank: usize) -> Solution {
        let spectrum = Spectrum::of(gram);
        let epsilon = self.damping_threshold;
        let squared = match rank {
            0 => 0.0,
            rank => spectrum.values[rank - 1],
        };
        let damping = (epsilon * epsilon - squared).max(0.0).sqrt();
        let damping = damping.min(task.most_damping);
        let mut velocity = [0.0; MAX_JOINTS];
        if free.count_ones() as usize > rank {
            velocity = null_motion(task, &spectrum, free, rank);
            let fade = (squared / (epsilon * epsilon)).min(1.0);
            velocity = velocity.map(|v| v * fade);
        }
        let y = spectrum.solve(rank, damping, task.goal);
        add_transposed(&mut velocity, task.columns, y, free);
        Solution {
            velocity,
            damping,
            free,
        }
    }
}

/// Undamped solution away from singularities, with three or more free joints.
#[inline]
fn regular(task: &Task, gram: &DMat3, free: usize) -> Solution {
    let mut velocity = [0.0; MAX_JOINTS];
    if free.count_ones() == 3 {
        // The inverse loses fewer digits than that of `J J^T`.
        let (mut square, mut joints) = (DMat3::ZERO, [0; 3]);
        for (index, joint) in joints_of(free).enumerate().take(3) {
            *square.col_mut(index) = task.columns[joint];
            joints[index] = joint;
        }
        let solution = square.inverse() * task.goal;
        for (joint, value) in joints.into_iter().zip(solution.to_array()) {
            velocity[joint] = value;
        }
    } else {
        let mut goal = task.goal;
        for joint in joints_of(free) {
            velocity[joint] = task.pull[joint];
            goal -= task.columns[joint] * task.pull[joint];
        }
        add_transposed(&mut velocity, task.columns, gram.inverse() * goal, free);
    }
    Solution {
        velocity,
        damping: 0.0,
        free,
    }
}

/// `N z`: the self-motion without its components along the right singular vectors `J^T v / |J^T v|`.
fn null_motion(task: &Task, spectrum: &Spectrum, free: usize, rank: usize) -> [f64; MAX_JOINTS] {
    let mut motion = [0.0; MAX_JOINTS];
    for joint in joints_of(free) {
        motion[joint] = task.pull[joint];
    }
    for vector in spectrum.vectors.iter().take(rank) {
        let (mut squared, mut along) = (0.0, 0.0);
        for joint in joints_of(free) {
            let entry = task.columns[joint].dot(*vector);
            squared += entry * entry;
            along += entry * motion[joint];
        }
        // A singular value of 0 fades the self-motion out.
        if squared > 0.0 {
            add_transposed(
                &mut motion,
                task.columns,
                *vector * (-along / squared),
                free,
            );
        }
    }
    motion
}

/// Adds `J^T y` for the joints in `free`.
#[inline]
fn add_transposed(
    velocity: &mut [f64; MAX_JOINTS],
    columns: &[DVec3; MAX_JOINTS],
    y: DVec3,
    free: usize,
) {
    for joint in joints_of(free) {
        velocity[joint] += columns[joint].dot(y);
    }
}

/// Indices of the joints in `free`.
#[inline]
fn joints_of(free: usize) -> impl Iterator<Item = usize> {
    (0..MAX_JOINTS).filter(move |joint| free & (1 << joint) != 0)
}
