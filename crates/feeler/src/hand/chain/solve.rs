//! Least-squares solution of eq. (1) within bounds of the joint velocities, in scaled units.
//!
//! The formula is that of [`resolved_rate`](super::resolved_rate).

use super::spectrum::Spectrum;
use super::task_rank::gram;
use super::{Chain, MAX_JOINTS};
use glam::{DMat3, DVec3};

/// Lowest and highest velocity of each joint, in scaled units.
pub(super) type Bounds = [[f64; 2]; MAX_JOINTS];

/// Linear system to be solved for joint velocities, in scaled units.
pub(super) struct Task<'a> {
    /// Columns of the scaled Jacobian.
    pub(super) columns: &'a [DVec3; MAX_JOINTS],
    /// Desired fingertip velocity or displacement.
    pub(super) goal: DVec3,
    /// Desired self-motion z. Its projection N z, which does not move the fingertip, is added.
    pub(super) pull: [f64; MAX_JOINTS],
    /// Lowest (at most 0) and highest (at least 0) velocity of each joint.
    pub(super) bounds: Bounds,
    /// Upper bound of the damping lambda (m/rad).
    pub(super) most_damping: f64,
}

/// Solution of a [`Task`].
pub(super) struct Solution {
    pub(super) velocity: [f64; MAX_JOINTS],
    /// Damping lambda (m/rad).
    pub(super) damping: f64,
    /// Bit mask of the joints that are not at their bound, as in [`TaskRanks`](super::task_rank::TaskRanks).
    pub(super) free: usize,
}

impl Chain {
    /// Solves `task`. While a joint exceeds its bound, fixes the joint that exceeds it most and solves again for the
    /// others.
    #[inline]
    pub(super) fn solve_within_bounds(&self, task: &Task) -> Solution {
        let mut free = (1 << self.joint_count()) - 1;
        let (mut fixed, mut goal) = ([0.0; MAX_JOINTS], task.goal);
        // Each pass fixes another joint.
        loop {
            let mut solution = self.solve(task, goal, free);
            let Some((joint, bound)) = worst(&solution.velocity, &task.bounds, free) else {
                for (velocity, fixed) in solution.velocity.iter_mut().zip(fixed) {
                    *velocity += fixed;
                }
                return solution;
            };
            free &= !(1 << joint);
            fixed[joint] = bound;
            goal -= task.columns[joint] * bound;
        }
    }

    /// Solves `task` for the remaining `goal` with the joints in the bit mask `free`.
    #[inline]
    fn solve(&self, task: &Task, goal: DVec3, free: usize) -> Solution {
        let rank = self.ranks.rank(free);
        let gram = gram(task.columns, free);
        if rank == 3 && self.is_regular(&gram) {
            return regular(task, goal, &gram, free);
        }
        self.near_singularity(task, goal, &gram, free)
    }

    /// `true` only if the smallest singular value certainly exceeds epsilon. Uses that the product of the other two
    /// eigenvalues of `gram` is at most the square of half their sum.
    #[inline]
    fn is_regular(&self, gram: &DMat3) -> bool {
        let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        let epsilon = self.damping_threshold;
        gram.determinant() >= 0.25 * trace * trace * epsilon * epsilon
    }

    /// Computes the solution from the singular vectors, for any rank.
    fn near_singularity(&self, task: &Task, goal: DVec3, gram: &DMat3, free: usize) -> Solution {
        let rank = self.ranks.rank(free);
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
        let y = spectrum.solve(rank, damping, goal);
        add_transposed(&mut velocity, task.columns, y, free);
        Solution {
            velocity,
            damping,
            free,
        }
    }
}

/// Index of the joint in `free` whose velocity exceeds its bound most, with that bound; `None` if none does.
#[inline]
fn worst(velocity: &[f64; MAX_JOINTS], bounds: &Bounds, free: usize) -> Option<(usize, f64)> {
    let (mut found, mut most) = (None, 0.0);
    for joint in joints_of(free) {
        let [lowest, highest] = bounds[joint];
        for (excess, bound) in [
            (velocity[joint] - highest, highest),
            (lowest - velocity[joint], lowest),
        ] {
            if excess > most {
                (found, most) = (Some((joint, bound)), excess);
            }
        }
    }
    found
}

/// Computes the undamped solution away from singularities, with three or more free joints.
#[inline]
fn regular(task: &Task, mut goal: DVec3, gram: &DMat3, free: usize) -> Solution {
    let mut velocity = [0.0; MAX_JOINTS];
    if free.count_ones() == 3 {
        // The inverse loses fewer digits than that of `J J^T`.
        let (mut square, mut joints) = (DMat3::ZERO, [0; 3]);
        for (index, joint) in joints_of(free).enumerate().take(3) {
            *square.col_mut(index) = task.columns[joint];
            joints[index] = joint;
        }
        let solution = square.inverse() * goal;
        for (joint, value) in joints.into_iter().zip(solution.to_array()) {
            velocity[joint] = value;
        }
    } else {
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

/// Computes the projection `N z`: the self-motion without its components along the right singular vectors `J^T v / |J^T
/// v|`.
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

/// Adds `J^T y` to `velocity` for the joints in `free`.
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

/// Indices of the joints in the bit mask `free`.
#[inline]
fn joints_of(free: usize) -> impl Iterator<Item = usize> {
    (0..MAX_JOINTS).filter(move |joint| free & (1 << joint) != 0)
}
