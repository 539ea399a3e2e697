//! The finger speed estimator (paper, Fig. 5): from the mode and the flags to a fingertip velocity.

use super::flags::FingerFlags;
use glam::DVec3;

/// The reflex that presses a slipping or weakly grasping finger into the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflex {
    /// v_r: speed of re-compression, m/s.
    pub recompression_speed: f64,
    /// A moving finger whose grasp force is below this is re-compressed, too, N.
    pub minimum_grasp_force: f64,
}

/// What the task wants of a finger until further notice.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Plan {
    /// Velocity of the fingertip, m/s, in W: v_0 in SEARCH, v_m in MOVE.
    pub velocity: DVec3,
    /// Where the object is thought to be: a unit vector in W.
    pub towards_object: DVec3,
    /// Whether the finger re-compresses when it slips.
    pub reflex: bool,
    /// Whether the finger re-compresses when its grasp force is low.
    pub keep_grasp: bool,
}

/// Estimates one finger's velocity and keeps it while neither plan nor flags change.
#[derive(Debug, Clone)]
pub struct FingerSpeedEstimator {
    reflex: Reflex,
    situation: Option<Situation>,
    velocity: DVec3,
}

/// What the velocity depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Situation {
    plan: Plan,
    touch: bool,
    slip: bool,
    over: bool,
    weak: bool,
}

impl FingerSpeedEstimator {
    /// An estimator for a finger at rest.
    pub fn new(reflex: Reflex) -> Self {
        Self {
            reflex,
            situation: None,
            velocity: DVec3::ZERO,
        }
    }

    /// Velocity of the fingertip, m/s, in W. `pressing` is the direction that presses the touching
    /// element of largest F_z further into the object: its outward dome normal, in W, if there is
    /// such an element.
    pub fn estimate(&mut self, plan: &Plan, flags: &FingerFlags, pressing: Option<DVec3>) -> DVec3 {
        let situation = Situation {
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

    /// The re-compressive velocity: none while an element is over its limit.
    fn recompression(&self, situation: &Situation, pressing: Option<DVec3>) -> DVec3 {
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
