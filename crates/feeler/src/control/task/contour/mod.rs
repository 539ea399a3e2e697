//! The contour task: one finger moves once around an unknown upright object and traces its outline by touch alone.
//!
//! The finger keeps its height and contact force and moves along the surface, which is on its left. The force shows
//! the direction of the surface: the sum of normal force and friction is tilted back from the surface normal by the
//! friction angle, which is learnt along the way.

mod config;
mod outline;

pub use config::ContourConfig;

use super::homing::homeward;
use super::search::check_search;
use super::surface::touching;
use super::{Finding, Task};
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::{FingerReadings, HandReadings};
use crate::control::stop_reason::StopReason;
use crate::math::direction_at;
use glam::{DVec2, DVec3};
use outline::Outline;
use std::f64::consts::TAU;

/// Maximum friction angle (rad), for a coefficient of 3.
const MAX_LEAN: f64 = 1.25;

/// Minimum rotation of the normal for a closed outline (rad). It is less than a full turn because the finger may
/// start at a corner, or before it knows the friction.
const MAX_OF_A_TURN: f64 = 0.75 * TAU;

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct Contour {
    config: ContourConfig,
    home: DVec3,
    approach: DVec3,
    phase: Phase,
    /// Outward normal of the surface, a horizontal unit vector in W.
    normal: DVec2,
    /// Angle between the force and the normal (rad): the friction angle.
    lean: f64,
    /// Force along the normal (N); 0 without touch.
    force: f64,
    /// Time at which the finger began to follow the outline (s).
    began: f64,
    /// Time of the latest contact (s).
    touched: f64,
    /// Time of the previous step (s).
    previous: f64,
    /// Position at which it released the object (m, in W).
    release_start: DVec3,
    outline: Outline,
    findings: [Finding; 6],
    outcome: Option<&'static str>,
}

impl Contour {
    /// Creates the task in its initial state.
    pub fn new(config: &ContourConfig) -> Self {
        let home = DVec3::from_array(config.home);
        let approach = DVec3::from_array(config.approach).with_z(0.0);
        let approach = approach.normalize_or_zero();
        Self {
            config: config.clone(),
            home,
            approach,
            phase: Phase::Search,
            normal: -approach.truncate(),
            lean: 0.0,
            force: 0.0,
            began: 0.0,
            touched: 0.0,
            previous: f64::NAN,
            release_start: home,
            outline: Outline::new(),
            findings: [
                "surface_x_m",
                "surface_y_m",
                "size_x_m",
                "size_y_m",
                "turned_rad",
                "friction",
            ]
            .map(Finding::unknown),
            outcome: None,
        }
    }

    /// Updates the normal and the friction angle from the forces.
    fn feel(&mut self, finger: &FingerReadings<'_>, stamp: f64) {
        let elapsed = stamp - self.previous;
        let elapsed = if elapsed.is_finite() { elapsed } else { 0.0 };
        let config = &self.config;
        let force: DVec3 = touching(finger, config.touch_force).map(|(_, f)| f).sum();
        let force = force.truncate();
        if let Some(direction) = force.try_normalize() {
            self.normal = direction_at(self.lean).rotate(direction);
            self.force = force.dot(self.normal);
            self.touched = stamp;
            if self.phase == Phase::Move {
                let missing = config.contact_force - self.force;
                let lean = self.lean + config.friction_gain * elapsed * missing;
                self.lean = lean.clamp(0.0, MAX_LEAN);
            }
        } else {
            self.force = 0.0;
        }
    }

    /// Velocity along the surface plus force control (m/s, in W).
    ///
    /// If the force is low, as at a corner, the finger first presses and then moves on.
    fn along_surface(&self) -> DVec3 {
        let config = &self.config;
        let excess = self.force - config.contact_force;
        let off = if self.force == 0.0 {
            -config.press_speed
        } else {
            (config.force_gain * excess).clamp(-config.press_speed, config.press_speed)
        };
        let share = (self.force / config.contact_force).clamp(0.0, 1.0);
        let along = share * config.follow_speed;
        (along * self.normal.perp() + off * self.normal).extend(0.0)
    }

    /// Adds the contact point of the most loaded element to the outline.
    fn draw(&mut self, finger: &FingerReadings<'_>) {
        let level = |(_, force): &(usize, DVec3)| force.truncate().length();
        let hardest =
            touching(finger, self.config.touch_force).max_by(|a, b| level(a).total_cmp(&level(b)));
        let Some((element, force)) = hardest else {
            return;
        };
        let (Some(tip), Some(direction)) = (
            self.config.feeler.tip(finger, element, force),
            force.truncate().try_normalize(),
        ) else {
            return;
        };
        let normal = direction_at(self.lean).rotate(direction);
        let point = tip.truncate() - self.config.feeler.tip_radius * normal;
        self.outline.add(point, normal);
        let (size, turned) = (self.outline.size(), self.outline.turned());
        let values = [
            point.x,
            point.y,
            size.x,
            size.y,
            turned,
            libm::tan(self.lean),
        ];
        for (finding, value) in self.findings.iter_mut().zip(values) {
            finding.value = value;
        }
    }

    fn follow(&mut self, finger: &FingerReadings<'_>, stamp: f64) {
        self.draw(finger);
        let config = &self.config;
        let closed =
            self.outline.turned() >= MAX_OF_A_TURN && self.outline.gap() <= config.closing_distance;
        let outcome = if closed {
            Some("closed")
        } else if stamp - self.touched > config.lost_time {
            Some("contact lost")
        } else if stamp - self.began > config.follow_limit {
            Some("not closed")
        } else {
            None
        };
        if outcome.is_some() {
            self.outcome = outcome;
            self.release_start = finger.pose.position;
            self.phase = Phase::Release;
        }
    }
}

impl Task for Contour {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let Some(finger) = hand.finger(0) else {
            return Ok(());
        };
        let position = finger.pose.position;
        match self.phase {
            Phase::Search => {
                self.feel(&finger, hand.stamp);
                if self.force >= self.config.contact_force {
                    self.began = hand.stamp;
                    self.phase = Phase::Move;
                } else {
                    let travel = (position - self.home).dot(self.approach);
                    check_search(0, travel, self.config.search_limit)?;
                }
            }
            Phase::Move => {
                self.feel(&finger, hand.stamp);
                self.follow(&finger, hand.stamp);
            }
            Phase::Release if position.distance(self.release_start) >= self.config.clearance => {
                self.phase = Phase::Return;
            }
            Phase::Return if position.distance(self.home) <= self.config.home_tolerance => {
                self.phase = Phase::Done;
            }
            _ => {}
        }
        self.previous = hand.stamp;
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let Some(sense) = hand.finger(finger) else {
            return Plan::default();
        };
        let config = &self.config;
        let position = sense.pose.position;
        let outward = self.normal.extend(0.0);
        let velocity = match self.phase {
            Phase::Search => config.search_speed * self.approach,
            Phase::Move => self.along_surface() + keep_height(self.home, position, config),
            Phase::Release => config.return_speed * outward,
            Phase::Return => homeward(self.home - position, config.return_speed),
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: -outward,
            ..Plan::default()
        }
    }

    accessors!(phase, findings, outcome);

    fn failed(&self) -> bool {
        self.outcome.is_some_and(|outcome| outcome != "closed")
    }
}

/// Velocity that keeps a finger at the height of its home (m/s).
fn keep_height(home: DVec3, position: DVec3, config: &ContourConfig) -> DVec3 {
    let level = home.with_x(position.x).with_y(position.y);
    homeward(level - position, config.follow_speed)
}
