//! Parameters of feelers and of friction in an experiment file.

use super::relaxation::RelaxationConfig;
use feeler::check::{Checker, MAX};
use serde::{Deserialize, Serialize};

/// Parameters of a feeler of silicone rubber.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeelerConfig {
    /// Stiffness along the axis (N/m). For a feeler that relaxes: instantaneous stiffness.
    pub normal_stiffness: f64,
    /// Stiffness across the axis (N/m). For a feeler that relaxes: instantaneous stiffness.
    pub shear_stiffness: f64,
    /// Radius of the rounded tip (m).
    pub tip_radius: f64,
    /// Friction coefficient of a sticking tip.
    pub static_friction: f64,
    /// Friction coefficient of a slipping tip.
    pub kinetic_friction: f64,
    /// Speed scale of Stribeck friction (m/s); see [`Friction::stribeck_speed`].
    pub stribeck_speed: f64,
    /// Damping along the axis (N·s/m).
    pub normal_damping: f64,
    /// Damping across the axis (N·s/m).
    pub shear_damping: f64,
    /// Relative increase of the shear stiffness with compression (1/m). The force derives from a potential, so shear
    /// also increases the normal force, and energy is conserved.
    pub normal_shear_coupling: f64,
    /// Compression at which the feeler reaches its base and becomes ten times as stiff (m); no limit by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_limit: Option<f64>,
    /// Viscoelastic relaxation and creep; elastic by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relaxation: Option<RelaxationConfig>,
}

impl Default for FeelerConfig {
    /// Soft silicone rubber of the reference experiment: elastic, without damping.
    fn default() -> Self {
        Self {
            normal_stiffness: 205.0,
            shear_stiffness: 127.0,
            tip_radius: 0.0021,
            static_friction: 1.14,
            kinetic_friction: 0.78,
            stribeck_speed: 0.0,
            normal_damping: 0.0,
            shear_damping: 0.0,
            normal_shear_coupling: 0.0,
            length_limit: None,
            relaxation: None,
        }
    }
}

/// Friction between a feeler and an object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Coefficient of a sticking tip.
    pub static_friction: f64,
    /// Coefficient of a slipping tip.
    pub kinetic_friction: f64,
    /// Speed scale `v_s` of Stribeck friction (m/s): at the speed `v` of the surface relative to the undeformed tip,
    /// the coefficient of a slipping tip has fallen by `1 - exp(-v / v_s)` of the difference between static and
    /// kinetic. With 0 it is always the kinetic one.
    #[serde(default)]
    pub stribeck_speed: f64,
}

impl Friction {
    /// Scales both coefficients by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            static_friction: self.static_friction * factor,
            kinetic_friction: self.kinetic_friction * factor,
            ..self
        }
    }

    /// Friction at a relative `speed` of the surface (m/s).
    pub fn at_speed(self, speed: f64) -> Self {
        if self.stribeck_speed <= 0.0 {
            return self;
        }
        let remaining = libm::exp(-speed / self.stribeck_speed);
        let drop = self.static_friction - self.kinetic_friction;
        Self {
            kinetic_friction: self.kinetic_friction + remaining * drop,
            ..self
        }
    }

    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let kinetic = self.kinetic_friction;
        checker.not_negative(&format!("{key}.kinetic_friction"), kinetic);
        checker.not_negative(&format!("{key}.stribeck_speed"), self.stribeck_speed);
        checker.require(
            &format!("{key}.static_friction"),
            self.static_friction.to_string(),
            self.static_friction <= MAX && self.static_friction >= kinetic,
            &format!("at least {key}.kinetic_friction = {kinetic}, at most {MAX:e}"),
        );
    }
}

impl FeelerConfig {
    /// Returns `true` if the feeler is a pure spring: linear, without damping or relaxation.
    pub(crate) fn is_spring(&self) -> bool {
        *self == self.as_spring()
    }

    /// Copy of the feeler with only its linear elasticity. The constants let the compiler remove everything else.
    #[inline(always)]
    pub(crate) fn as_spring(&self) -> Self {
        Self {
            normal_stiffness: self.normal_stiffness,
            shear_stiffness: self.shear_stiffness,
            tip_radius: self.tip_radius,
            static_friction: self.static_friction,
            kinetic_friction: self.kinetic_friction,
            stribeck_speed: self.stribeck_speed,
            normal_damping: 0.0,
            shear_damping: 0.0,
            normal_shear_coupling: 0.0,
            length_limit: None,
            relaxation: None,
        }
    }

    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("normal_stiffness", self.normal_stiffness),
            ("shear_stiffness", self.shear_stiffness),
            ("tip_radius", self.tip_radius),
        ];
        checker.all_positive(key, &positive);
        let not_negative = [
            ("normal_damping", self.normal_damping),
            ("shear_damping", self.shear_damping),
            ("normal_shear_coupling", self.normal_shear_coupling),
        ];
        for (field, value) in not_negative {
            checker.not_negative(&format!("{key}.{field}"), value);
        }
        if let Some(limit) = self.length_limit {
            checker.positive(&format!("{key}.length_limit"), limit);
        }
        if let Some(relaxation) = &self.relaxation {
            relaxation.check(&format!("{key}.relaxation"), checker);
        }
        self.friction().check(key, checker);
    }
}
