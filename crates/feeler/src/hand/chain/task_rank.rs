//! Number of directions in which the joints of a chain can move its fingertip.

use super::spectrum::Spectrum;
use super::{Chain, MAX_JOINTS};
use glam::{DMat3, DVec3};

/// Fraction of the damping threshold epsilon below which a singular value counts as 0.
const NEGLIGIBLE: f64 = 0.1;

/// Number of sampled joint positions from which the rank is determined.
const SAMPLES: usize = 16;

/// Constant phi of the sequence of [`Chain::sample`], for one to seven dimensions: the root above 1 of `x^(n + 1) = x +
/// 1`.
const PHI: [f64; MAX_JOINTS] = [
    1.618_033_988_749_895,
    1.324_717_957_244_746,
    1.220_744_084_605_759_5,
    1.167_303_978_261_418_7,
    1.134_724_138_401_519_4,
    1.112_775_684_278_705_5,
    1.096_981_557_798_559_8,
];

/// Maximum rank of the Jacobian of each subset of the joints. Bit j of the index is set if joint j is in the subset.
///
/// The fingertip of a planar chain, for example, moves in two directions, regardless of the number of joints. Its third
/// singular value is 0 everywhere, which is not a singularity that needs damping.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TaskRanks([u8; 1 << MAX_JOINTS]);

impl Default for TaskRanks {
    fn default() -> Self {
        Self([0; 1 << MAX_JOINTS])
    }
}

impl TaskRanks {
    /// Determines the ranks of all subsets from the Jacobian at joint positions that are spread over the joints'
    /// ranges.
    pub(super) fn of(chain: &Chain) -> Self {
        let mut ranks = Self::default();
        let least = NEGLIGIBLE * chain.damping_threshold;
        for index in 0..SAMPLES {
            let columns = chain.scaled_jacobian(&chain.sample(index));
            for (subset, rank) in ranks
                .0
                .iter_mut()
                .enumerate()
                .take(1 << chain.joint_count())
            {
                let values = Spectrum::of(&gram(&columns, subset)).values;
                let above = values.iter().filter(|value| **value > least * least);
                *rank = (*rank).max(above.count() as u8);
            }
        }
        ranks
    }

    /// Maximum rank of the Jacobian columns of the joints in `subset`.
    pub(super) fn rank(&self, subset: usize) -> usize {
        self.0.get(subset).map_or(0, |&rank| rank.into())
    }
}

/// Gram matrix `J J^T` of the columns in `subset`.
#[inline]
pub(super) fn gram(columns: &[DVec3; MAX_JOINTS], subset: usize) -> DMat3 {
    let mut sum = DMat3::ZERO;
    for (joint, column) in columns.iter().enumerate() {
        if subset & (1 << joint) != 0 {
            sum.x_axis += *column * column.x;
            sum.y_axis += *column * column.y;
            sum.z_axis += *column * column.z;
        }
    }
    sum
}

impl Chain {
    /// Point `index` of a sequence that fills the joints' ranges evenly, starting in their middle: the additive
    /// recurrence with powers of 1 / phi of M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
    pub(super) fn sample(&self, index: usize) -> [f64; MAX_JOINTS] {
        let phi = PHI[self.joint_count() - 1];
        let (mut values, mut alpha) = ([0.0; MAX_JOINTS], 1.0);
        for (value, joint) in values.iter_mut().zip(&self.joints) {
            alpha /= phi;
            let share = (0.5 + alpha * index as f64).fract();
            *value = joint.lower + share * (joint.upper - joint.lower);
        }
        values
    }

    /// Jacobian with respect to joint positions in scaled units, whose columns are all in m/rad.
    #[inline]
    pub(super) fn scaled_jacobian(&self, joints: &[f64]) -> [DVec3; MAX_JOINTS] {
        self.scaled(self.jacobian(joints))
    }

    /// Converts Jacobian `columns` to scaled units: multiplies each by the scale of its joint.
    #[inline]
    pub(super) fn scaled(&self, mut columns: [DVec3; MAX_JOINTS]) -> [DVec3; MAX_JOINTS] {
        for (column, joint) in columns.iter_mut().zip(&self.joints) {
            *column *= joint.scale;
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phi_is_the_root() {
        for (index, phi) in PHI.into_iter().enumerate() {
            let dimensions = index as i32 + 1;
            // Rounding of up to 8 factors.
            assert!((phi.powi(dimensions + 1) - phi - 1.0).abs() < 1e-14);
        }
    }
}
