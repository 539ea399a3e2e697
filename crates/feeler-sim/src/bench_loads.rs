//! Which loads a calibration bench puts on which element, and when.

use super::calibration_bench::CalibrationBenchConfig;
use feeler::sensor::layout::ElementLayout;
use glam::{DVec2, DVec3};
use rand::{RngExt, seq::SliceRandom};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// What is done with one load on one element; the force in its frame `E_i`, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// A live page, which cannot exist in this build.
    None,
    /// It is for fitting.
    Fitted(DVec3),
    /// It is kept from the fit.
    HeldOut(DVec3),
    /// It is one of a cycle.
    Cycled(DVec3),
}

impl Load {
    /// The same with another shear force.
    fn with_shear(self, shear: impl Fn(DVec2) -> DVec2) -> Self {
        let with = |force: DVec3| shear(force.truncate()).extend(force.z);
        match self {
            Self::None => Self::None,
            Self::Fitted(force) => Self::Fitted(with(force)),
            Self::HeldOut(force) => Self::HeldOut(with(force)),
            Self::Cycled(force) => Self::Cycled(with(force)),
        }
    }

    /// The force in the element's frame `E_i`, N.
    pub fn force(self) -> DVec3 {
        match self {
            Self::None => DVec3::ZERO,
            Self::Fitted(force) | Self::HeldOut(force) | Self::Cycled(force) => force,
        }
    }
}

/// All loads for one element, in random order but for the cycles. Of a skin on which loads reach their neighbours, all elements are
/// unloaded at once, at first.
pub(super) fn program(bench: &CalibrationBenchConfig, rng: &mut Pcg64) -> Vec<Load> {
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

/// A load with equally likely compressions, directions and shares of the largest shear force.
fn load_in_friction_cone(bench: &CalibrationBenchConfig, rng: &mut Pcg64) -> DVec3 {
    let normal = bench.largest_normal * rng.random::<f64>();
    let shear = bench.largest_friction * normal * rng.random::<f64>();
    let direction = DVec2::from_angle(TAU * rng.random::<f64>());
    (shear * direction).extend(normal)
}

/// The loads of `own`, each put on the patch of about `radius`, m, around its element; patches meet, so that most elements bear what a
/// neighbour's program says. Shear keeps its direction across a patch. With a radius of 0, what `own` says.
pub(super) fn in_patches(
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
