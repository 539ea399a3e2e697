//! Control law for sensors that measure only compression. Without shear, neither slip nor the used friction is known,
//! so the grasp force is regulated to the value that an assumed friction requires for an assumed load.

use super::{FRICTION, Law};
use crate::check::Checker;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Assumptions and parameters of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NormalOnlyConfig {
    /// Assumed friction coefficient.
    pub friction: f64,
    /// Assumed tangential load on a finger (N).
    pub tangential_load: f64,
    /// Pressing speed per missing grasp force (m/(N·s)).
    pub gain: f64,
    /// Maximum speed of pressing or yielding (m/s).
    pub pressing_speed: f64,
}

impl Default for NormalOnlyConfig {
    /// The load corresponds to 42 mN·m, the closing torque of the reference experiment, on a cap of 14 mm radius held
    /// between two fingers.
    fn default() -> Self {
        Self {
            friction: 0.8,
            tangential_load: 1.5,
            gain: 0.01,
            pressing_speed: 0.006,
        }
    }
}

impl NormalOnlyConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let key = |field: &str| format!("{key}.{field}");
        checker.between(&key("friction"), self.friction, FRICTION.0, FRICTION.1);
        checker.not_negative(&key("tangential_load"), self.tangential_load);
        checker.not_negative(&key("gain"), self.gain);
        checker.not_negative(&key("pressing_speed"), self.pressing_speed);
    }
}

/// State of the law for one finger.
#[derive(Debug, Clone)]
pub struct NormalOnly {
    config: NormalOnlyConfig,
}

impl NormalOnly {
    /// Creates the law with the given configuration.
    pub fn new(config: NormalOnlyConfig) -> Self {
        Self { config }
    }
}

impl Law for NormalOnly {
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        if !plan.keep_grasp {
            return plan.velocity;
        }
        // Use only flags that derive from compression: neither TOUCH nor SLIP.
        let flags = finger.flags();
        let pressing = flags.largest_element.and_then(|e| finger.normal(e));
        let direction = pressing.unwrap_or(plan.towards_object);
        let needed = self.config.tangential_load / self.config.friction;
        let most = if flags.over {
            0.0
        } else {
            self.config.pressing_speed
        };
        let speed = self.config.gain * (needed - flags.grasp_force);
        plan.velocity + speed.clamp(-self.config.pressing_speed, most) * direction
    }
}
