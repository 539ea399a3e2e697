//! Control law with which all fingers turn the object about a pivot estimated from contact points. Not in the paper.
//!
//! The law requires neither a model of the object nor tuning for the hand. While a finger closes, the law measures the
//! contact stiffness of its feelers (`stiffness.rs`). The displaced tips of all feelers in contact then lie on the
//! object's surface; a circle through them (`circle.rs`) gives the pivot. In the phase MOVE, each fingertip moves
//! around the pivot at a radius that is adapted from stroke to stroke, so that the largest element force approaches
//! `peak_force` times F2 (`stroke.rs`). With [`Grip::AsNeeded`], the radius instead follows the grasp force that the
//! load requires (`needed_grip.rs`).
//!
//! The object's axis is assumed to be parallel to z of W; positions are x and y in W.

mod circle;
mod course;
mod finger;
mod friction;
mod needed_grip;
mod stiffness;
mod stroke;

use super::HandLaw;
use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use crate::control::plan::Plan;
use crate::control::sense::HandReadings;
use crate::sensor::fingertip::layout::ElementLayout;
use circle::{Circle, CircleFit};
use finger::{Finger, Motion};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Firmness of the grip.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grip {
    /// As firm as the rated force of the elements allows. Turns the object with the largest torque.
    #[default]
    Firm,
    /// Slightly firmer than necessary to prevent slip. Squeezes the object least.
    AsNeeded,
}

impl Grip {
    fn is_firm(&self) -> bool {
        *self == Self::Firm
    }
}

/// Parameters of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PivotConfig {
    /// Target firmness of the grip.
    #[serde(skip_serializing_if = "Grip::is_firm")]
    pub grip: Grip,
    /// Target of the largest element force in a stroke, relative to F2.
    pub peak_force: f64,
    /// Element force above which a finger retreats from the object, relative to F2; must be at least `peak_force`.
    pub guard_force: f64,
    /// Radial speed per radial position error (1/s).
    pub gain: f64,
    /// Maximum deviation from the circle that may be used to keep the grasp force constant: standard deviation of the
    /// radius, relative to that of the planned straight line.
    pub path_tolerance: f64,
}

impl Default for PivotConfig {
    /// Values chosen on simulated hands with the seeds 101 to 107 and 20000 to 60149. With a drive lag of 30 ms and a
    /// control period of 10 ms, oscillation starts at a gain of about 30/s.
    fn default() -> Self {
        Self {
            grip: Grip::Firm,
            peak_force: 1.16,
            guard_force: 1.19,
            gain: 12.0,
            path_tolerance: 0.25,
        }
    }
}

impl PivotConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let key = |field: &str| format!("{key}.{field}");
        checker.between(&key("peak_force"), self.peak_force, 0.1, 10.0);
        let (peak, most) = (self.peak_force, 10.0);
        checker.between(&key("guard_force"), self.guard_force, peak, most);
        checker.between(&key("gain"), self.gain, 0.1, 100.0);
        checker.between(&key("path_tolerance"), self.path_tolerance, 0.0, 1.0);
    }
}

/// State of the law for one hand, with its estimates of stiffness, pivot and radius.
#[derive(Debug, Clone)]
pub struct Pivot {
    config: PivotConfig,
    /// F2: rated force of an element (N).
    rated_force: f64,
    fingers: Vec<Finger>,
    /// Circle fit through the contact points so far; `None` before all fingers have closed for the first time.
    contacts: Option<CircleFit>,
    /// Circle through the contact points.
    circle: Option<Circle>,
}

impl Pivot {
    /// Creates the law for fingers with the elements of `layouts`. F2 in `thresholds` is the rated force of an element;
    /// elements above F1 give contact points.
    pub fn new(
        config: &PivotConfig,
        thresholds: &FlagThresholds,
        layouts: &[ElementLayout],
    ) -> Self {
        let finger = |layout| Finger::new(layout, thresholds.touch_force);
        Self {
            config: config.clone(),
            rated_force: thresholds.over_force,
            fingers: layouts.iter().map(finger).collect(),
            contacts: None,
            circle: None,
        }
    }

    /// Starts the circle fit. The prior is the circle between several fingertips, or a circle of the dome's size in
    /// front of a single fingertip.
    fn start_circle(&mut self, plans: &[Plan]) {
        let (centre, radius) = match &self.fingers[..] {
            [lone] => {
                let inward = plans.first().map_or(DVec3::ZERO, |p| p.towards_object);
                let reach = 2.0 * lone.dome_radius();
                let centre = lone.position() + reach * inward.truncate().normalize_or_zero();
                (centre, lone.dome_radius())
            }
            fingers => {
                let count = fingers.len() as f64;
                let centre = fingers.iter().map(Finger::position).sum::<DVec2>() / count;
                let clearance =
                    |finger: &Finger| finger.position().distance(centre) - finger.dome_radius();
                (centre, fingers.iter().map(clearance).sum::<f64>() / count)
            }
        };
        self.contacts = Some(CircleFit::new(centre, radius));
        self.circle = Some(Circle { centre, radius });
    }

    /// Updates slip detection and the required grasp force of each finger. All fingers turn the same object, so the
    /// smallest of their estimates of the fraction of the motion that the object has followed applies to all of them.
    fn feel_slip(&mut self, hand: &HandReadings<'_>) {
        let fingers = self.fingers.iter_mut().zip(hand.fingers());
        let along = fingers.map(|(finger, sense)| finger.foretell_shear(&sense));
        let along = along.fold(1.0, f64::min);
        for (finger, sense) in self.fingers.iter_mut().zip(hand.fingers()) {
            finger.feel_slip(&sense, self.circle, along);
        }
    }

    /// Offset of the pivot from the centre of the fingers' start positions (m); zero for a single finger.
    fn pivot_offset(&self, circle: &Circle) -> DVec2 {
        if self.fingers.len() < 2 {
            return DVec2::ZERO;
        }
        let homes: DVec2 = self.fingers.iter().map(Finger::home).sum();
        circle.centre - homes / self.fingers.len() as f64
    }
}

impl HandLaw for Pivot {
    fn observe(&mut self, hand: &HandReadings<'_>, closed: &mut [Option<bool>]) {
        for (finger, sense) in self.fingers.iter_mut().zip(hand.fingers()) {
            finger.feel(&sense, self.contacts.as_mut());
        }
        self.circle = self.contacts.as_ref().map(CircleFit::circle);
        if self.config.grip == Grip::AsNeeded {
            self.feel_slip(hand);
        }
        for (finger, closed) in self.fingers.iter().zip(closed) {
            *closed = finger.has_closed(&self.config, self.rated_force, self.circle);
        }
    }

    fn velocities(&mut self, plans: &[Plan], hand: &HandReadings<'_>, velocities: &mut [DVec3]) {
        let all_grasp = !plans.is_empty() && plans.iter().all(|plan| plan.keep_grasp);
        if all_grasp && self.contacts.is_none() {
            self.start_circle(plans);
        }
        let circle = self.circle;
        for (finger, plan) in self.fingers.iter_mut().zip(plans) {
            finger.follow(plan, &self.config, self.rated_force, circle);
        }
        let offset = circle.map_or(DVec2::ZERO, |circle| self.pivot_offset(&circle));
        let fingers = self.fingers.iter_mut().zip(plans).zip(hand.fingers());
        for (((finger, plan), sense), velocity) in fingers.zip(velocities) {
            *velocity = match (finger.motion(), circle) {
                (Motion::Close, Some(circle)) => finger.close(plan, &self.config, circle, offset),
                (Motion::Turn, Some(circle)) => {
                    finger.turn(plan, &self.config, self.rated_force, circle, &sense)
                }
                _ => plan.velocity,
            };
        }
    }
}
