//! Viscoelastic relaxation of the feelers' rubber: a standard linear solid (Zener model) per feeler.
//!
//! A spring acts in parallel with a Maxwell element, a spring in series with a dashpot. Right after a fast deformation
//! both bear load, with the stiffness `K` of [`FeelerConfig`]; finally only the spring does, with `(1 - share) K`.
//! The equivalent form is one spring of stiffness `K` with a moving rest position: `F = K (d - p)`, where `d` is the
//! displacement of the undeformed tip from the anchor. The creep displacement `p`, the *set*, follows it with
//! `dp/dt = (share d - p) / time`.
//!
//! - At constant deformation the force falls as `K d (1 - share (1 - exp(-t / time)))`.
//! - At constant force the feeler creeps with time constant `time / (1 - share)`, by `share / (1 - share)` of its
//!   initial deformation.
//! - A feeler without contact has zero force, so it recovers with the time constant of creep. If it touches before it
//!   has recovered, it is still shortened and bent.
//!
//! The set belongs to the rubber and is stored in the fingertip's frame. Slips, and turning within a step, act against
//! the full stiffness. The forces due to `normal_shear_coupling` and `length_limit` do not relax: they depend on the
//! feeler's shape, that is on `d`.
//!
//! [`FeelerConfig`]: super::feeler_config::FeelerConfig

use feeler::check::Checker;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Creep displacements below this are set to zero (m): far below the resolution of an image, far above slow subnormal
/// numbers.
const FORGOTTEN: f64 = 1e-15;

/// Parameters of the relaxation of a feeler.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxationConfig {
    /// Fraction of the instantaneous stiffness (`normal_stiffness`, `shear_stiffness`) that relaxes.
    pub share: f64,
    /// Relaxation time: time constant of the force at constant deformation (s).
    pub time: f64,
}

impl RelaxationConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        // With a share of 1 the rubber would flow and never recover.
        checker.between(&format!("{key}.share"), self.share, 0.0, 0.99);
        checker.positive(&format!("{key}.time"), self.time);
    }

    /// Time constant of creep at constant force, and of recovery without contact (s).
    pub fn creep_time(&self) -> f64 {
        self.time / (1.0 - self.share)
    }

    /// Creep displacement (*set*, m) after `duration` (s) at constant `displacement` (m, in the same frame).
    pub fn held(&self, set: DVec3, displacement: DVec3, duration: f64) -> DVec3 {
        let end = self.share * displacement;
        end + libm::exp(-duration / self.time) * (set - end)
    }

    /// Creep displacement (*set*, m) of a feeler after `duration` (s) without contact.
    pub fn recovered(&self, set: DVec3, duration: f64) -> DVec3 {
        let left = set * libm::exp(-duration / self.creep_time());
        if left.length_squared() < FORGOTTEN * FORGOTTEN {
            return DVec3::ZERO;
        }
        left
    }
}
