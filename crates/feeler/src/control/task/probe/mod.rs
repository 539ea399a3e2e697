//! The probing routine: touches, presses and releases, shears while sticking, and slides, at three places.
//!
//! The routine estimates nothing itself. Its forces, joint angles and commands are sufficient to identify contact
//! stiffness, friction, drives and the object, for any hand. The finding `step` is the number of the current
//! [`Step`]; a stroke is one place.
//!
//! The fingers move alike: neighbouring fingers probe on the same side of the object, and all of them shear and slide
//! along its axis. So opposing fingers exert no torque about that axis, and an object that turns easily stays at
//! rest.

mod config;
mod finger;
mod step;

pub use config::ProbeConfig;
pub use step::Step;

use super::{Finding, Task};
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::HandReadings;
use crate::control::stop_reason::StopReason;
use finger::{Finger, PLACES};
use glam::DVec3;

/// Durations of the rest before the first step and of the pauses between steps (s). Drives settle in them; noise is
/// measured in the first.
const REST: f64 = 0.5;
const PAUSE: f64 = 0.1;

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct Probe {
    config: ProbeConfig,
    fingers: Vec<Finger>,
    step: Step,
    place: u32,
    /// Time at which the step began (s); `None` before the first control step.
    since: Option<f64>,
    /// Time at which all fingers completed the step (s); `None` before.
    through: Option<f64>,
    findings: [Finding; 1],
}

impl Probe {
    /// Number of places that are probed.
    pub const PLACES: u32 = PLACES;

    /// Creates the task in its initial state.
    pub fn new(config: &ProbeConfig) -> Self {
        let homes = config
            .finger
            .iter()
            .map(|path| DVec3::from_array(path.home));
        let centre = homes.sum::<DVec3>() / config.finger.len().max(1) as f64;
        let fingers = config.finger.iter().enumerate();
        Self {
            fingers: fingers
                .map(|(index, path)| Finger::new(index, path, centre))
                .collect(),
            config: config.clone(),
            step: Step::Rest,
            place: 0,
            since: None,
            through: None,
            findings: [Finding {
                name: "step",
                value: 0.0,
            }],
        }
    }

    fn begin_next(&mut self, hand: &HandReadings<'_>) {
        if self.step == Step::Retract && self.place + 1 < PLACES {
            self.step = Step::Travel;
            self.place += 1;
        } else {
            self.step = self.step.next();
        }
        self.since = Some(hand.stamp);
        self.through = None;
        self.findings[0].value = f64::from(self.step as u8);
        for (finger, pose) in self.fingers.iter_mut().zip(hand.poses) {
            finger.begin(self.step, pose.position);
        }
    }
}

impl Task for Probe {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let elapsed = hand.stamp - *self.since.get_or_insert(hand.stamp);
        let fingers = self.fingers.iter_mut().zip(hand.fingers());
        for (index, (finger, sense)) in fingers.enumerate() {
            finger.advance(index, self.step, self.place, elapsed, &sense, &self.config)?;
        }
        let rests = self.step == Step::Rest && elapsed < REST;
        if !rests && self.fingers.iter().all(Finger::is_through) {
            let through = *self.through.get_or_insert(hand.stamp);
            if hand.stamp - through >= PAUSE && self.step != Step::Done {
                self.begin_next(hand);
            }
        }
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let (Some(finger), Some(pose)) = (self.fingers.get(finger), hand.poses.get(finger)) else {
            return Plan::default();
        };
        Plan {
            velocity: finger.velocity(self.step, self.place, pose.position, &self.config),
            towards_object: finger.towards_object(),
            ..Plan::default()
        }
    }

    fn phase(&self) -> Phase {
        self.step.phase()
    }

    fn stroke(&self) -> u32 {
        self.place + 1
    }

    fn findings(&self) -> &[Finding] {
        &self.findings
    }
}
