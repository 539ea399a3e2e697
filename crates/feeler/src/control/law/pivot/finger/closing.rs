//! Closing motion of a finger.

use super::super::circle::Circle;
use super::super::stroke::StrokeParameters;
use super::super::{Grip, PivotConfig};
use super::{Finger, Motion, Onset};
use crate::control::plan::Plan;
use glam::{DVec2, DVec3};

/// Largest element force at which the first closing motion ends, as a fraction of F2.
const FIRST_CLOSING: f64 = 0.8;
/// Like [`FIRST_CLOSING`], but for [`Grip::AsNeeded`], whose load is still unknown.
const LIGHT_CLOSING: f64 = 0.3;
/// Fraction of a displacement of the object's surface that is added to the radius: a compromise between 1, for an
/// object that turned with the finger, and 0, for an object that stayed at rest.
const SURFACE_PART: f64 = 0.5;
/// Maximum distance from the target radius at which a finger counts as closed (m).
const CLOSED_WITHIN: f64 = 2e-5;
/// Minimum approach speed, relative to the planned speed.
const SLOWEST: f64 = 0.1;
/// Lateral distance from the start of its stroke above which a finger waits at the distance [`WAIT_AT`] (m).
const ASIDE: f64 = 2e-4;
/// Distance from the target radius at which a finger waits (m).
const WAIT_AT: f64 = 0.004;
/// Maximum lateral speed while closing (m/s).
const SIDEWAYS_SPEED: f64 = 0.005;

impl Finger {
    /// Returns whether a closing finger has reached its radius or its force limit; `None` if the finger is not
    /// closing, or if the task's grasp force decides.
    pub fn has_closed(
        &self,
        config: &PivotConfig,
        rated_force: f64,
        circle: Option<Circle>,
    ) -> Option<bool> {
        if self.motion != Motion::Close {
            return None;
        }
        match (self.lesson, circle) {
            (Some(lesson), Some(circle)) => {
                let left = self.position.distance(circle.centre) - self.radius(&lesson, &circle);
                Some(left < CLOSED_WITHIN || self.force > config.guard_force * rated_force)
            }
            _ => {
                let share = match config.grip {
                    Grip::Firm => FIRST_CLOSING,
                    Grip::AsNeeded => LIGHT_CLOSING,
                };
                (self.force > share * rated_force).then_some(true)
            }
        }
    }

    /// Radius of the current stroke (m): the radius in `lesson`, corrected for the displacement of the object's surface
    /// at the first contact.
    pub(super) fn radius(&self, lesson: &StrokeParameters, circle: &Circle) -> f64 {
        let (Some(now), Some(before), Some(k)) = (self.onset, self.onset_before, self.stiffness)
        else {
            return lesson.radius;
        };
        let surface =
            |onset: Onset| onset.position.distance(circle.centre) + onset.force / k.normal;
        lesson.radius + SURFACE_PART * (surface(now) - surface(before))
    }

    /// Velocity of a closing finger (m/s, in W): towards its radius, and sideways to the planned start of its stroke,
    /// which is shifted by `offset` (m), the pivot's offset from the hand's centre.
    pub fn close(&self, plan: &Plan, config: &PivotConfig, circle: Circle, offset: DVec2) -> DVec3 {
        let Some(lesson) = self.lesson else {
            return plan.velocity;
        };
        let left = self.position.distance(circle.centre) - self.radius(&lesson, &circle);
        let speed = plan.velocity.length();
        let slowed = (config.gain * left).clamp(SLOWEST * speed, speed);
        let approach = plan.velocity.clamp_length_max(slowed);
        let direction = self.course.direction;
        let aside = (offset - (self.position - self.home())).dot(direction);
        if speed == 0.0 || self.grip > 0.0 {
            return approach;
        }
        let sideways = (config.gain * aside).clamp(-SIDEWAYS_SPEED, SIDEWAYS_SPEED) * direction;
        let waits = aside.abs() > ASIDE && left < WAIT_AT;
        let approach = if waits { DVec3::ZERO } else { approach };
        approach + sideways.extend(0.0)
    }
}
