//! Parameters of a simulated calibration bench.

use crate::optics::config::OpticsConfig;
use feeler::sensor::calibration::{FullScale, ModelChoice};
use feeler::sensor::fingertip::FingertipConfig;
use serde::{Deserialize, Serialize};

/// Loads that are applied to each element.
///
/// The separable model cannot fit all loads, so their selection matters. Most are inside the friction cone, as they are
/// while a cap is turned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CalibrationBenchConfig {
    /// Seed of the order of loads and of the camera's noise.
    pub seed: u64,
    /// Maximum compression (N).
    pub largest_normal: f64,
    /// Maximum ratio of shear force to compression, like a friction coefficient.
    pub largest_friction: f64,
    /// Number of images without load.
    pub unloaded: usize,
    /// Number of loads of pure compression, up to the maximum.
    pub normal_sweep: usize,
    /// Number of loads in each of two sweeps of shear, along x and y, at half the maximum compression.
    pub shear_sweep: usize,
    /// Number of combined loads, random inside the friction cone.
    pub combined: usize,
    /// Number of additional combined loads that are held out from the fit for validation.
    pub held_out: usize,
    /// Number of load cycles of each element at the end, for repeatability and hysteresis: in steps up to half the
    /// maximum compression and half of its maximum shear force.
    pub cycles: usize,
    /// Approximate radius of the patches to which loads are applied (m), because an object presses on several elements
    /// of a skin. With 0, elements are loaded independently.
    pub contact_radius: f64,
    /// Model to fit.
    pub model: ModelChoice,
    /// Full scale that relative errors refer to.
    pub full_scale: FullScale,
}

impl Default for CalibrationBenchConfig {
    fn default() -> Self {
        Self {
            seed: 1,
            largest_normal: 2.0,
            largest_friction: 0.9,
            unloaded: 32,
            normal_sweep: 40,
            shear_sweep: 40,
            combined: 400,
            held_out: 200,
            cycles: 8,
            contact_radius: 0.0,
            model: ModelChoice::Separable,
            full_scale: FullScale::default(),
        }
    }
}

impl CalibrationBenchConfig {
    /// Configuration for a fingertip with `combined` combined loads, and loads of other kinds in proportion. With more than 41 elements,
    /// forces are reduced so that the total force stays the same. On a skin with markers, the radius of patches is
    /// three times its spread.
    pub fn of_fingertip(
        fingertip: &FingertipConfig,
        optics: &OpticsConfig,
        combined: usize,
    ) -> Self {
        /// Number of elements for which the default values are chosen.
        const ELEMENTS: f64 = 41.0;
        let default = Self::default();
        let share = |count: usize| (count * combined).div_ceil(default.combined);
        let elements = fingertip.layout.element_count().max(1) as f64;
        let largest_normal = default.largest_normal * (ELEMENTS / elements).min(1.0);
        Self {
            largest_normal,
            contact_radius: optics
                .markers
                .as_ref()
                .map_or(0.0, |markers| 3.0 * markers.spread),
            full_scale: FullScale {
                normal: largest_normal,
                shear: 0.5 * largest_normal,
            },
            combined,
            unloaded: share(default.unloaded).max(2),
            normal_sweep: share(default.normal_sweep),
            shear_sweep: share(default.shear_sweep),
            held_out: share(default.held_out),
            ..default
        }
    }
}
