//! Feelers and their friction, as an experiment file describes them.

use super::relaxation::RelaxationConfig;
use feeler::check::{Checker, MAX};
use serde::{Deserialize, Serialize};

/// A feeler of silicone rubber.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeelerConfig {
    /// Stiffness along the feeler's axis, N/m: that of a quick deformation, where the feeler relaxes.
    pub normal_stiffness: f64,
    /// Stiffness across the feeler's axis, N/m: that of a quick deformation, where the feeler relaxes.
    pub shear_stiffness: f64,
    /// Radius of the feeler's rounded tip, m.
    pub tip_radius: f64,
    /// Friction coefficient of a tip that sticks to the object.
    pub static_friction: f64,
    /// Friction coefficient of a tip that slips over the object.
    pub kinetic_friction: f64,
    /// See [`Friction::stribeck_speed`], m/s.
    pub stribeck_speed: f64,
    /// Damping along the feeler's axis, N·s/m.
    pub normal_damping: f64,
    /// Damping across the feeler's axis, N·s/m.
    pub shear_damping: f64,
    /// Growth of the shear stiffness with compression, relative, 1/m. It comes from a potential, so
    /// that shear presses the object away in turn and no energy is made.
    pub normal_shear_coupling: f64,
    /// Compression at which the feeler meets its base and is ten times as stiff, m; none by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_limit: Option<f64>,
    /// How the rubber relaxes and creeps; by default it is elastic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relaxation: Option<RelaxationConfig>,
}

impl Default for FeelerConfig {
    /// The reference experiment's soft silicone rubber: elastic, without damping.
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
    /// Coefficient while the tip sticks.
    pub static_friction: f64,
    /// Coefficient while the tip slips.
    pub kinetic_friction: f64,
    /// Speed of the surface under the undeformed tip, m/s, at which a slip's drop from the static to
    /// the kinetic limit is 1 - 1/e of the whole drop (`1 - exp(-v / v_s)`); 0: always the whole.
    #[serde(default)]
    pub stribeck_speed: f64,
}

impl Friction {
    /// Both coefficients, `factor` times as large.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            static_friction: self.static_friction * factor,
            kinetic_friction: self.kinetic_friction * factor,
            ..self
        }
    }

    /// The friction of a surface that passes under the tip at `speed`, m/s.
    pub fn at_speed(self, speed: f64) -> Self {
        if self.stribeck_speed <= 0.0 {
            return self;
        }
        let remaining = (-speed / self.stribeck_speed).exp();
        let drop = self.static_friction - self.kinetic_friction;
        Self {
            kinetic_friction: self.kinetic_friction + remaining * drop,
            ..self
        }
    }

    /// Requires every value of the table `key` to be in its range.
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
    /// Whether it is a spring and nothing else, without damping or relaxation.
    pub(super) fn is_spring(&self) -> bool {
        *self == self.as_spring()
    }

    /// The feeler as the spring that it is beside everything else. The compiler sees that the rest is nothing.
    #[inline(always)]
    pub(super) fn as_spring(&self) -> Self {
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

    /// Requires every value of the table `key` to be in its range.
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
