//! The paper's control law (finger speed estimator, Fig. 5): computes the fingertip velocity from the plan and the
//! contact flags.

use super::Law;
use crate::control::flags::FingerFlags;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use glam::DVec3;

/// Parameters of the reflex that presses a slipping or weakly grasping finger into the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflex {
    /// v_r: speed at which the finger is pressed into the object (re-compression, m/s).
    pub recompression_speed: f64,
    /// Grasp force below which a moving finger is pressed into the object, as after a slip (N).
    pub minimum_grasp_force: f64,
}

/// The paper's law for one finger. Keeps the velocity while neither plan nor flags change.
#[derive(Debug, Clone)]
pub struct TriAxialLaw {
    reflex: Reflex,
    situation: Option<LawInputs>,
    velocity: DVec3,
}

/// Inputs that determine the velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LawInputs {
    plan: Plan,
    touch: bool,
    slip: bool,
    over: bool,
    weak: bool,
}

impl Law for TriAxialLaw {
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        let flags = finger.flags();
        let pressing = flags.largest_element.and_then(|e| finger.normal(e));
        self.estimate(plan, flags, pressing)
    }
}

impl TriAxialLaw {
    /// Creates the law for a finger at rest.
    pub fn new(reflex: Reflex) -> Self {
        Self {
            reflex,
            situation: None,
            velocity: DVec3::ZERO,
        }
    }

    /// Velocity of the fingertip (m/s, in W). `pressing` is the outward dome normal (in W) of the element in contact
    /// with the largest F_z, if any: the direction that presses it further into the object.
    pub fn estimate(&mut self, plan: &Plan, flags: &FingerFlags, pressing: Option<DVec3>) -> DVec3 {
        let situation = LawInputs {
            plan: *plan,
            touch: flags.touch,
            slip: flags.slip,
            over: flags.over,
            weak: plan.keep_grasp && flags.grasp_force < self.reflex.minimum_grasp_force,
        };
        if self.situation != Some(situation) {
            self.situation = Some(situation);
            self.velocity = plan.velocity + self.recompression(&situation, pressing);
        }
        self.velocity
    }

    /// Re-compressive velocity; zero while an element is over its limit.
    fn recompression(&self, situation: &LawInputs, pressing: Option<DVec3>) -> DVec3 {
        let slipping = situation.slip && situation.plan.reflex;
        let direction = match pressing {
            _ if situation.over => DVec3::ZERO,
            Some(normal) if slipping || situation.weak => normal,
            None if situation.weak => situation.plan.towards_object,
            _ => DVec3::ZERO,
        };
        self.reflex.recompression_speed * direction
    }
}
