//! Overrides of feeler parameters for single elements.

use crate::contact::feeler_config::FeelerConfig;
use crate::contact::relaxation::RelaxationConfig;
use serde::{Deserialize, Serialize};

/// Overrides of `sim.feeler` for some elements of one finger. Missing values are not overridden.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ElementConfig {
    /// Index of the finger, from 0.
    pub finger: usize,
    /// Indices of the elements, from 0.
    pub elements: Vec<usize>,
    /// Overrides [`FeelerConfig::normal_stiffness`] (N/m).
    pub normal_stiffness: Option<f64>,
    /// Overrides [`FeelerConfig::shear_stiffness`] (N/m).
    pub shear_stiffness: Option<f64>,
    /// Overrides [`FeelerConfig::normal_damping`] (N·s/m).
    pub normal_damping: Option<f64>,
    /// Overrides [`FeelerConfig::shear_damping`] (N·s/m).
    pub shear_damping: Option<f64>,
    /// Overrides [`FeelerConfig::static_friction`].
    pub static_friction: Option<f64>,
    /// Overrides [`FeelerConfig::kinetic_friction`].
    pub kinetic_friction: Option<f64>,
    /// Overrides [`FeelerConfig::stribeck_speed`] (m/s).
    pub stribeck_speed: Option<f64>,
    /// Overrides [`FeelerConfig::normal_shear_coupling`] (1/m).
    pub normal_shear_coupling: Option<f64>,
    /// Overrides [`FeelerConfig::length_limit`] (m).
    pub length_limit: Option<f64>,
    /// Overrides [`FeelerConfig::relaxation`].
    pub relaxation: Option<RelaxationConfig>,
}

impl ElementConfig {
    /// Applies the overrides to the parameters `usual`.
    pub fn feeler(&self, usual: &FeelerConfig) -> FeelerConfig {
        FeelerConfig {
            normal_stiffness: self.normal_stiffness.unwrap_or(usual.normal_stiffness),
            shear_stiffness: self.shear_stiffness.unwrap_or(usual.shear_stiffness),
            tip_radius: usual.tip_radius,
            normal_damping: self.normal_damping.unwrap_or(usual.normal_damping),
            shear_damping: self.shear_damping.unwrap_or(usual.shear_damping),
            static_friction: self.static_friction.unwrap_or(usual.static_friction),
            kinetic_friction: self.kinetic_friction.unwrap_or(usual.kinetic_friction),
            stribeck_speed: self.stribeck_speed.unwrap_or(usual.stribeck_speed),
            normal_shear_coupling: self
                .normal_shear_coupling
                .unwrap_or(usual.normal_shear_coupling),
            length_limit: self.length_limit.or(usual.length_limit),
            relaxation: self.relaxation.or(usual.relaxation),
        }
    }
}
