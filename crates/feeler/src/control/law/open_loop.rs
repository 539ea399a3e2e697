//! Control law that follows the plan without tactile feedback, as if only the object's position were known.
//!
//! The task's approach ends at its own grasp force under every law; that defines the start of a stroke and is not part
//! of the law. From there, a finger presses in by a planned distance, so that the straight stroke does not leave the
//! round object, and then follows its path regardless of forces.

use super::Law;
use crate::check::Checker;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Motion that the law adds to the task's path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OpenLoopConfig {
    /// Distance by which a grasping finger is pressed further towards the object (m).
    pub squeeze: f64,
    /// Speed of the additional pressing motion (m/s).
    pub squeeze_speed: f64,
}

impl Default for OpenLoopConfig {
    /// The stroke of the reference task, to 7.35 mm past the cap's apex, deviates by 0.75 mm from the circle of 34.1 mm
    /// on which fingertip and cap touch. The squeeze compensates most of that; soft feelers, pressed by 1.0 N when the
    /// stroke begins, stay in contact for the rest. A larger squeeze would press elements beyond their limit.
    fn default() -> Self {
        Self {
            squeeze: 0.0005,
            squeeze_speed: 0.004,
        }
    }
}

impl OpenLoopConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.between(&format!("{key}.squeeze"), self.squeeze, 0.0, 0.1);
        checker.not_negative(&format!("{key}.squeeze_speed"), self.squeeze_speed);
    }
}

/// State of the law for one finger.
#[derive(Debug, Clone)]
pub struct OpenLoop {
    config: OpenLoopConfig,
    /// Position at which the grasp began (m, in W); `None` while the plan requires no grasp.
    grasped_at: Option<DVec3>,
}

impl OpenLoop {
    /// Creates the law with the given configuration.
    pub fn new(config: OpenLoopConfig) -> Self {
        Self {
            config,
            grasped_at: None,
        }
    }
}

impl Law for OpenLoop {
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        if !plan.keep_grasp {
            self.grasped_at = None;
            return plan.velocity;
        }
        let position = finger.pose.position;
        let start = *self.grasped_at.get_or_insert(position);
        let pressed = (position - start).dot(plan.towards_object);
        if pressed < self.config.squeeze {
            plan.velocity + self.config.squeeze_speed * plan.towards_object
        } else {
            plan.velocity
        }
    }
}
