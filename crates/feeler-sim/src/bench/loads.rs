//! Sequence of loads that a calibration bench applies to each element.

use super::config::CalibrationBenchConfig;
use feeler::math::direction_at;
use feeler::sensor::fingertip::ElementLayout;
use glam::{DVec2, DVec3};
use rand::{RngExt, seq::SliceRandom};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// One load on one element and its use. Forces are in the element's frame `E_i` (N).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// Unloaded.
    None,
    /// Used for the fit.
    Fitted(DVec3),
    /// Held out from the fit, for validation.
    HeldOut(DVec3),
    /// Part of a load cycle.
    Cycled(DVec3),
}

impl Load {
    /// Copy with another shear force.
    fn with_shear(self, shear: impl Fn(DVec2) -> DVec2) -> Self {
        let with = |force: DVec3| shear(force.truncate()).extend(force.z);
        match self {
            Self::None => Self::None,
            Self::Fitted(force) => Self::Fitted(with(force)),
            Self::HeldOut(force) => Self::HeldOut(with(force)),
            Self::Cycled(force) => Self::Cycled(with(force)),
        }
    }

    /// Force in the element's frame `E_i` (N).
    pub fn force(self) -> DVec3 {
        match self {
            Self::None => DVec3::ZERO,
            Self::Fitted(force) | Self::HeldOut(force) | Self::Cycled(force) => force,
        }
    }
}

/// Sequence of loads for one element: loads in random order, then the cycles. With patches, the unloaded samples come
/// first, so that all elements are unloaded at the same time.
pub(crate) fn program(bench: &CalibrationBenchConfig, rng: &mut Pcg64) -> Vec<Load> {
    let mut loads = vec![Load::None; bench.unloaded];
    for step in 1..=bench.normal_sweep {
        let normal = bench.largest_normal * step as f64 / bench.normal_sweep as f64;
        loads.push(Load::Fitted(normal * DVec3::Z));
    }
    let normal = 0.5 * bench.largest_normal;
    for axis in [DVec3::X, DVec3::Y] {
        for step in 0..bench.shear_sweep {
            let along = 2.0 * (step as f64 + 0.5) / bench.shear_sweep as f64 - 1.0;
            let shear = along * bench.largest_friction * normal;
            loads.push(Load::Fitted(normal * DVec3::Z + shear * axis));
        }
    }
    for _ in 0..bench.combined {
        loads.push(Load::Fitted(load_in_friction_cone(bench, rng)));
    }
    for _ in 0..bench.held_out {
        loads.push(Load::HeldOut(load_in_friction_cone(bench, rng)));
    }
    let unloaded_together = match bench.contact_radius > 0.0 {
        true => bench.unloaded,
        false => 0,
    };
    loads[unloaded_together..].shuffle(rng);
    let peak = 0.5 * bench.largest_normal * (DVec3::Z + 0.5 * bench.largest_friction * DVec3::X);
    for _ in 0..bench.cycles {
        let steps = [0.5, 1.0, 0.5, 0.0];
        loads.extend(steps.map(|share| Load::Cycled(share * peak)));
    }
    loads
}

/// Random load with uniformly distributed compression, direction, and fraction of the maximum shear force.
fn load_in_friction_cone(bench: &CalibrationBenchConfig, rng: &mut Pcg64) -> DVec3 {
    let normal = bench.largest_normal * rng.random::<f64>();
    let shear = bench.largest_friction * normal * rng.random::<f64>();
    let direction = direction_at(TAU * rng.random::<f64>());
    (shear * direction).extend(normal)
}

/// Divides the elements into patches of about `radius` (m) and loads each element of a patch like its central element
/// in `own`. The direction of shear is constant in a patch. Returns `own` if `radius` is 0.
pub(crate) fn in_patches(
    layout: &ElementLayout,
    radius: f64,
    own: Vec<Load>,
    rng: &mut Pcg64,
) -> Vec<Load> {
    if radius == 0.0 {
        return own;
    }
    let distance = |a: usize, b: usize| layout.tip(a).distance(layout.tip(b));
    let mut order: Vec<usize> = (0..own.len()).collect();
    order.shuffle(rng);
    let mut middles: Vec<usize> = Vec::new();
    for element in order {
        if middles
            .iter()
            .all(|&other| distance(element, other) > 1.5 * radius)
        {
            middles.push(element);
        }
    }
    let nearest = |element| {
        let near =
            |a: &&usize, b: &&usize| distance(**a, element).total_cmp(&distance(**b, element));
        middles
            .iter()
            .min_by(near)
            .map_or(element, |&middle| middle)
    };
    (0..own.len())
        .map(|element| {
            let middle = nearest(element);
            let turned =
                layout.elements[element].rotation.transpose() * layout.elements[middle].rotation;
            own[middle].with_shear(|shear| {
                let along = (turned * shear.extend(0.0)).truncate();
                shear.length() * along.normalize_or_zero()
            })
        })
        .collect()
}
