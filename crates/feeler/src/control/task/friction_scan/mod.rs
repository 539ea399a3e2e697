//! The friction scan: one finger presses on a flat specimen, slides back and forth, and measures both friction
//! coefficients from tri-axial forces alone (first task of the paper's earlier study).
//!
//! The specimen may be tilted. In the plane of pressing and sliding, the tilt cancels out between both directions
//! (see [`stick_slip`]). A tilt `b` across that plane makes the coefficients too large by `1 / cos b`, 0.4 % at 5
//! degrees.

mod angle_sum;
mod config;
pub mod stick_slip;

pub use config::FrictionScanConfig;

use super::homing::homeward;
use super::search::check_search;
use super::{Finding, Task};
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::{FingerReadings, HandReadings};
use crate::control::stop_reason::StopReason;
use angle_sum::AngleSum;
use glam::DVec3;
use stick_slip::{FrictionEstimate, Slips, StickSlip};

/// Compression below which an element does not count towards the load (N), because the errors of many untouched
/// elements would add up.
const TOUCHING: f64 = 0.05;
/// Maximum friction coefficient of rubber. If an element still sticks beyond it, something else holds the element,
/// and the scan ends to protect it.
const GREATEST_FRICTION: f64 = 3.0;
/// Number of frames at rest that determines the noise to about a fifth.
const FRAMES_AT_REST: u64 = 10;

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct FrictionScan {
    config: FrictionScanConfig,
    home: DVec3,
    /// Orthogonal unit vectors in W.
    approach: DVec3,
    slide: DVec3,
    phase: Phase,
    stroke: u32,
    /// Time at which the finger began to settle (s), or `None` before and after.
    settling_since: Option<f64>,
    /// The element that is evaluated in this stroke: the one with the largest F_z at its start.
    element: usize,
    /// Sequence number of the latest evaluated frame.
    sequence: Option<u64>,
    /// Statistics of the angle at rest.
    rest: AngleSum,
    stick_slip: StickSlip,
    /// Position at which the stroke began (m, in W).
    stroke_start: DVec3,
    /// Distance covered in this stroke before its first slip (m).
    first_slip: Option<f64>,
    /// Statistics of the angle for strokes back and forth.
    slips: [Slips; 2],
    findings: [Finding; 4],
    outcome: Option<&'static str>,
}

impl FrictionScan {
    /// Creates the task in its initial state.
    pub fn new(config: &FrictionScanConfig) -> Self {
        let approach = DVec3::from_array(config.approach).normalize_or_zero();
        let slide = DVec3::from_array(config.slide).reject_from_normalized(approach);
        Self {
            config: config.clone(),
            home: DVec3::from_array(config.home),
            approach,
            slide: slide.normalize_or_zero(),
            phase: Phase::Search,
            stroke: 1,
            settling_since: None,
            element: 0,
            sequence: None,
            rest: AngleSum::default(),
            stick_slip: StickSlip::new(0.0),
            stroke_start: DVec3::ZERO,
            first_slip: None,
            slips: [Slips::default(); 2],
            findings: ["static_friction", "kinetic_friction", "tilt", "slips"]
                .map(Finding::unknown),
            outcome: None,
        }
    }

    /// Direction of this stroke, a unit vector in W.
    fn way(&self) -> DVec3 {
        match self.stroke % 2 {
            1 => self.slide,
            _ => -self.slide,
        }
    }

    /// Pressing force of the finger (N).
    fn load(&self, finger: &FingerReadings<'_>) -> f64 {
        let forces = finger.touch.frame.forces.iter().enumerate();
        let touching = forces.filter(|(_, force)| force.z > TOUCHING);
        let on_finger: DVec3 = touching.map(|(element, _)| finger.force(element)).sum();
        -on_finger.dot(self.approach)
    }

    /// Force angle of the evaluated element (rad), or `None` if there is no new frame or the element does not touch.
    fn new_angle(&mut self, finger: &FingerReadings<'_>) -> Option<f64> {
        let frame = &finger.touch.frame;
        if self.sequence.replace(frame.sequence) == Some(frame.sequence) {
            return None;
        }
        let touches = frame.forces.get(self.element)?.z > TOUCHING;
        let force = finger.force(self.element);
        let against = |direction: DVec3| -force.dot(direction);
        touches.then(|| libm::atan2(against(self.way()), against(self.approach)))
    }

    fn noise(&self) -> f64 {
        self.rest.variance().unwrap_or_default()
    }

    /// Holds still and measures the noise once the drives have come to rest.
    fn settle(&mut self, finger: &FingerReadings<'_>, settling_for: f64) {
        let angle = self.new_angle(finger);
        if let Some(angle) = angle.filter(|_| settling_for >= 0.5 * self.config.settle_time) {
            self.rest.add(angle);
        }
        if settling_for >= self.config.settle_time && self.rest.count() >= FRAMES_AT_REST {
            self.settling_since = None;
            self.begin_stroke(finger);
        }
    }

    fn begin_stroke(&mut self, finger: &FingerReadings<'_>) {
        self.element = finger.flags().largest_element.unwrap_or(self.element);
        self.stick_slip = StickSlip::new(self.noise());
        self.stroke_start = finger.pose.position;
        self.first_slip = None;
    }

    fn slide(&mut self, finger: &FingerReadings<'_>) {
        if let Some(angle) = self.new_angle(finger) {
            if angle > libm::atan(GREATEST_FRICTION) {
                return self.end("no slip");
            }
            // Pressing leaves shear in every direction, which the first stroke removes.
            let mut ignored = Slips::default();
            let slips = match self.stroke {
                1 => &mut ignored,
                stroke => &mut self.slips[(stroke % 2) as usize],
            };
            self.stick_slip.see(angle, slips);
        }
        let along = (finger.pose.position - self.stroke_start).dot(self.way());
        if self.stick_slip.slides() && self.first_slip.is_none() {
            self.first_slip = Some(along);
        }
        match self.first_slip {
            Some(first) if along - first >= self.config.travel => self.end_stroke(finger),
            None if along >= self.config.slide_limit => self.end("no slip"),
            _ => {}
        }
    }

    fn end_stroke(&mut self, finger: &FingerReadings<'_>) {
        let [backward, forward] = &self.slips;
        if let Some(found) = FrictionEstimate::estimate(forward, backward, self.noise()) {
            let falls = (forward.falls() + backward.falls()) as f64;
            let values = [
                found.static_friction,
                found.kinetic_friction,
                found.tilt,
                falls,
            ];
            for (finding, value) in self.findings.iter_mut().zip(values) {
                finding.value = value;
            }
        }
        if self.stroke < self.config.strokes {
            self.stroke += 1;
            self.begin_stroke(finger);
        } else {
            self.end("measured");
        }
    }

    fn end(&mut self, outcome: &'static str) {
        self.outcome = Some(outcome);
        self.phase = Phase::Release;
    }

    /// Velocity of sliding plus force control.
    fn sliding_velocity(&self, finger: &FingerReadings<'_>) -> DVec3 {
        let config = &self.config;
        let fastest = match finger.flags().over {
            true => 0.0,
            false => config.search_speed,
        };
        let press = config.load_gain * (config.load - self.load(finger));
        let press = press.clamp(-config.search_speed, fastest);
        config.slide_speed * self.way() + press * self.approach
    }
}

impl Task for FrictionScan {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let Some(finger) = hand.finger(0) else {
            return Ok(());
        };
        let from_home = finger.pose.position - self.home;
        let travel = from_home.dot(self.approach);
        if matches!(self.phase, Phase::Search | Phase::Move) {
            check_search(0, travel, self.config.search_limit)?;
        }
        match self.phase {
            Phase::Search if self.load(&finger) >= self.config.load => {
                self.phase = Phase::Move;
                self.settling_since = Some(hand.stamp);
                self.element = finger.flags().largest_element.unwrap_or_default();
            }
            Phase::Move => match self.settling_since {
                Some(since) => self.settle(&finger, hand.stamp - since),
                None => self.slide(&finger),
            },
            Phase::Release if travel <= 0.0 => self.phase = Phase::Return,
            Phase::Return if from_home.length() <= self.config.home_tolerance => {
                self.phase = Phase::Done;
            }
            _ => {}
        }
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let Some(sense) = hand.finger(finger) else {
            return Plan::default();
        };
        let velocity = match self.phase {
            Phase::Search => self.config.search_speed * self.approach,
            Phase::Move if self.settling_since.is_none() => self.sliding_velocity(&sense),
            Phase::Release => -self.config.return_speed * self.approach,
            Phase::Return => homeward(self.home - sense.pose.position, self.config.return_speed),
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: self.approach,
            // The finger must slip.
            reflex: false,
            keep_grasp: false,
        }
    }

    accessors!(phase, stroke, findings, outcome);

    fn failed(&self) -> bool {
        self.outcome.is_some_and(|outcome| outcome != "measured")
    }
}
