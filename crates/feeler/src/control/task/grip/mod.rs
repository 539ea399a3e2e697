//! The grip task: a gripper grasps an object, holds it with little force while it is carried, and releases it when it
//! is put down.
//!
//! All fingers close and open at the same speed, like those of a parallel gripper with one motor. The object is moved
//! by an arm, whose motion is unknown to the task. The load is estimated from the shear of the fingertips; if it
//! vanishes for a while, the object is assumed to have been put down.

mod carried_load;
mod config;
mod contact_load;
mod force_control;
mod partial_slip;
mod slip_signal;
mod softness;
mod surface;

pub use config::{GripConfig, GripLaw, PartialSlipConfig, SlipReflexConfig};

use super::carry::CarryFinger;
use super::homing::homeward;
use super::search::check_search;
use super::{Finding, Task};
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::HandReadings;
use crate::control::stop_reason::StopReason;
use crate::hand::MAX_FINGERS;
use crate::sensor::fingertip::MAX_ELEMENTS;
use carried_load::CarriedLoad;
use contact_load::{ElementLoad, FingerLoad};
use force_control::ForceControl;
use glam::DVec3;
use partial_slip::PartialSlip;
use slip_signal::SlipSignal;
use softness::Softness;
use surface::Surface;

/// Speed after the first contact, relative to the search speed.
const SLOW: f64 = 0.3;
/// Duration of the load after which the inclination of the surface is taken into account (s); before that, the contact
/// settles.
const INCLINED_FROM: f64 = 0.2;
/// Gain of the planned return to the position of the grasp, if a policy controls the fingers (1/s). Low, so that
/// the planned velocity, which the policy observes, stays proportional to the distance from the grasp.
const HOLDING: f64 = 1.0;
/// Distance by which each finger retracts from the object before it returns (m).
const CLEARANCE: f64 = 0.002;

/// State of one of the opposing fingers.
#[derive(Debug, Clone, Default)]
struct Jaw {
    home: DVec3,
    approach: DVec3,
    /// Buffer for the load on each element.
    elements: Vec<ElementLoad>,
    load: FingerLoad,
    /// Time of the latest contact (s).
    touched: f64,
    /// Closing distance from home at which the object was grasped (m).
    grasped: f64,
    /// Position at which the finger released the object (m, in W).
    let_go: DVec3,
}

impl Jaw {
    /// Largest pressing force of an element (N).
    fn deepest(&self) -> f64 {
        let pressing = self.elements.iter().map(|own| own.pressing);
        pressing.fold(0.0, f64::max)
    }

    /// Closing distance from home if the fingertip is at `position` (m, in W).
    fn closed(&self, position: DVec3) -> f64 {
        (position - self.home).dot(self.approach)
    }
}

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct Grip {
    config: GripConfig,
    jaws: Vec<Jaw>,
    partial_slip: PartialSlip,
    /// Slip detector of the law; `None` if the law does not use one.
    signal: Option<SlipSignal>,
    control: ForceControl,
    softness: Softness,
    /// Closing speed of each finger in contact (m/s).
    speed: f64,
    carried: CarriedLoad,
    /// Time at which the load became low (s); `None` if it is not low.
    low_since: Option<f64>,
    phase: Phase,
    /// Time of the previous step (s); `None` before the first one.
    previous: Option<f64>,
    /// Sequence number of each finger's latest frame.
    frames: [u64; MAX_FINGERS],
    findings: [Finding; 3],
    outcome: Option<&'static str>,
}

impl Grip {
    /// Creates the task in its initial state.
    pub fn new(config: &GripConfig) -> Self {
        let jaw = |finger: &CarryFinger| Jaw {
            home: finger.home.into(),
            approach: DVec3::from_array(finger.approach).normalize_or_zero(),
            elements: vec![ElementLoad::default(); MAX_ELEMENTS],
            ..Jaw::default()
        };
        let jaws: Vec<_> = config.finger.iter().take(MAX_FINGERS).map(jaw).collect();
        Self {
            partial_slip: PartialSlip::new(config.partial_slip, jaws.len()),
            jaws,
            signal: SlipSignal::new(config),
            control: ForceControl::new(config.stiffness),
            softness: Softness::new(config.feeler),
            speed: 0.0,
            carried: CarriedLoad::new(config.carried_load),
            low_since: None,
            phase: Phase::Search,
            previous: None,
            frames: [0; MAX_FINGERS],
            findings: ["pressing_n", "load_n", "friction"].map(Finding::unknown),
            outcome: None,
            config: config.clone(),
        }
    }

    /// Mean pressing force of a finger (N).
    fn grip(&self) -> f64 {
        self.mean(|jaw| jaw.load.pressing)
    }

    /// Smallest pressing force of all fingers (N).
    fn weakest(&self) -> f64 {
        let pressing = self.jaws.iter().map(|jaw| jaw.load.pressing);
        pressing.fold(f64::INFINITY, f64::min)
    }

    /// Mean equivalent load of a finger, including torsion (N).
    fn load(&self) -> f64 {
        self.mean(|jaw| jaw.load.equivalent)
    }

    /// Mean of the shear forces on all fingers (N, in W), in which the forces that the fingers exert on each other
    /// through the object cancel.
    fn load_vector(&self) -> DVec3 {
        let sum: DVec3 = self.jaws.iter().map(|jaw| jaw.load.shear).sum();
        sum / self.jaws.len().max(1) as f64
    }

    fn mean(&self, of: impl Fn(&Jaw) -> f64) -> f64 {
        self.jaws.iter().map(of).sum::<f64>() / self.jaws.len().max(1) as f64
    }

    /// Updates the load of each finger. Returns `true` if there are new frames.
    fn update_loads(&mut self, hand: &HandReadings<'_>, interval: f64) -> bool {
        let mut new = self.previous.is_none();
        let (feeler, touch_force) = (self.softness.in_series(), self.config.touch_force);
        let jaws = self.jaws.iter_mut().zip(&mut self.frames);
        for (index, ((jaw, frame), finger)) in jaws.zip(hand.fingers()).enumerate() {
            let sequence = finger.touch.frame.sequence;
            new |= std::mem::replace(frame, sequence) != sequence;
            let elements = ElementLoad::of_finger(&finger, jaw.approach, &mut jaw.elements);
            jaw.load = FingerLoad::new(&finger, elements, jaw.approach, touch_force);
            if jaw.load.touches {
                jaw.touched = hand.stamp;
            }
            if self.phase == Phase::Move && new {
                let surface = Surface::fit(&finger, jaw.approach, &feeler, touch_force);
                if let Some(surface) = surface {
                    ElementLoad::relate_to(&surface, &finger, &feeler, elements);
                }
                self.partial_slip
                    .add_finger(index, elements, &jaw.load, interval);
            }
        }
        new
    }

    /// Holds the object: updates the closing speed, and detects whether the object was lost or put down.
    fn hold(&mut self, hand: &HandReadings<'_>, interval: f64, new: bool) {
        if new {
            self.partial_slip.update_friction(interval);
        }
        self.carried
            .update(self.load_vector(), self.grip(), hand.stamp, interval);
        // No load: before lifting, the shear is from closing; once it has reversed, something supports the object.
        let load = if !self.carried.is_carried() || self.carried.is_supported() {
            0.0
        } else {
            match self.carried.is_for(INCLINED_FROM, hand.stamp) {
                true => self.partial_slip.on_surface(self.load(), self.grip()),
                false => self.load(),
            }
        };
        self.partial_slip.update_load(load, interval);
        let distances = self.jaws.iter().zip(hand.poses);
        let distances = distances.map(|(jaw, pose)| jaw.closed(pose.position));
        let distance = distances.sum::<f64>() / self.jaws.len().max(1) as f64;
        self.control.update(distance, self.grip());
        if new {
            let slips = match &mut self.signal {
                Some(signal) => signal.slips(hand, interval),
                None => false,
            };
            self.speed = self.closing_speed(hand, load, slips);
        }
        let lost = |jaw: &Jaw| hand.stamp - jaw.touched > self.config.lost_time;
        if self.jaws.iter().any(lost) {
            self.let_go(hand, "lost");
        } else if self.is_put_down(hand.stamp) {
            self.let_go(hand, "put down");
        }
    }

    /// Closing speed of each finger (m/s) that regulates the grip force to the one that the law requires for this
    /// `load` of a finger (N).
    fn closing_speed(&self, hand: &HandReadings<'_>, load: f64, slips: bool) -> f64 {
        let config = &self.config;
        let estimate = &self.partial_slip;
        // Before the object is lifted, the table may bear a part of one finger's force.
        let (grip, least) = match self.carried.is_for(config.load_up_time, hand.stamp) {
            true => (self.grip(), config.least_force),
            false => (self.weakest(), config.grip_force),
        };
        let most = config.max_force;
        let requested = match config.law {
            GripLaw::PartialSlip => estimate.required(grip, load),
            GripLaw::KnownFriction => {
                let friction = config.known_friction;
                estimate.required_at(config.known_utilisation, [friction; 2], grip, load)
            }
            GripLaw::Fixed => config.fixed_force,
            // These laws never open: at least the present grip.
            GripLaw::Reflex | GripLaw::MissingShear | GripLaw::Drag => grip,
            // The policy moves the fingers.
            GripLaw::Policy => return 0.0,
        };
        let missing = requested.clamp(least, most) - grip;
        let mut speed = self.control.speed(missing, config.bandwidth);
        if slips {
            speed += config.slip_reflex.speed;
        }
        // While an element is over its limit, the fingers do not close further.
        let over = hand.fingers().any(|finger| finger.flags().over) || grip >= most;
        let fastest = if over { 0.0 } else { config.press_speed };
        speed.clamp(-config.press_speed, fastest)
    }

    /// Returns `true` if the carried load has been low for long enough.
    fn is_put_down(&mut self, stamp: f64) -> bool {
        if !self.carried.is_below(self.config.put_down_share) {
            self.low_since = None;
            return false;
        }
        let since = *self.low_since.get_or_insert(stamp);
        let held = self.jaws.iter().all(|jaw| jaw.load.touches);
        held && stamp - since >= self.config.put_down_time
    }

    fn let_go(&mut self, hand: &HandReadings<'_>, outcome: &'static str) {
        for (jaw, pose) in self.jaws.iter_mut().zip(hand.poses) {
            jaw.let_go = pose.position;
        }
        self.outcome = Some(outcome);
        self.phase = Phase::Release;
    }

    fn all(&self, hand: &HandReadings<'_>, done: impl Fn(&Jaw, DVec3) -> bool) -> bool {
        let mut jaws = self.jaws.iter().zip(hand.poses);
        jaws.all(|(jaw, pose)| done(jaw, pose.position))
    }

    /// Closes the fingers until each of them presses with at least `grip_force`.
    fn search(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        if self
            .jaws
            .iter()
            .all(|jaw| jaw.deepest() > softness::START_FORCE)
        {
            let jaws = self.jaws.iter().zip(hand.poses);
            let closed = jaws.map(|(jaw, pose)| jaw.closed(pose.position)).sum();
            let force = self.jaws.iter().map(Jaw::deepest).sum();
            self.softness.update(closed, force);
        }
        let config = &self.config;
        if self.weakest() >= config.grip_force {
            for (jaw, pose) in self.jaws.iter_mut().zip(hand.poses) {
                jaw.grasped = jaw.closed(pose.position);
            }
            self.phase = Phase::Move;
            return Ok(());
        }
        for (index, (jaw, pose)) in self.jaws.iter().zip(hand.poses).enumerate() {
            check_search(index, jaw.closed(pose.position), config.search_limit)?;
        }
        let touched = self.jaws.iter().any(|jaw| jaw.load.touches);
        self.speed = config.search_speed * if touched { SLOW } else { 1.0 };
        Ok(())
    }
}

impl Task for Grip {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let interval = self.previous.map_or(0.0, |previous| hand.stamp - previous);
        let new = self.update_loads(hand, interval);
        match self.phase {
            Phase::Search => self.search(hand)?,
            Phase::Move => self.hold(hand, interval, new),
            Phase::Release => {
                let clear = |jaw: &Jaw, position: DVec3| {
                    (position - jaw.let_go).dot(jaw.approach) <= -CLEARANCE
                };
                if self.all(hand, clear) {
                    self.phase = Phase::Return;
                }
            }
            Phase::Return => {
                let tolerance = self.config.home_tolerance;
                if self.all(hand, |jaw, position| {
                    jaw.home.distance(position) <= tolerance
                }) {
                    self.phase = Phase::Done;
                }
            }
            Phase::Done | Phase::Stopped => {}
        }
        let values = [self.grip(), self.load(), self.partial_slip.friction()];
        for (finding, value) in self.findings.iter_mut().zip(values) {
            finding.value = value;
        }
        self.previous = Some(hand.stamp);
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let (Some(jaw), Some(pose)) = (self.jaws.get(finger), hand.poses.get(finger)) else {
            return Plan::default();
        };
        let config = &self.config;
        let reflex = self.phase == Phase::Move && config.law == GripLaw::Policy;
        let velocity = match self.phase {
            Phase::Move if reflex => {
                HOLDING * (jaw.grasped - jaw.closed(pose.position)) * jaw.approach
            }
            Phase::Search | Phase::Move => self.speed * jaw.approach,
            Phase::Release => -config.return_speed * jaw.approach,
            Phase::Return => homeward(jaw.home - pose.position, config.return_speed),
            Phase::Done | Phase::Stopped => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: jaw.approach,
            reflex,
            keep_grasp: false,
        }
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn findings(&self) -> &[Finding] {
        &self.findings
    }

    fn outcome(&self) -> Option<&'static str> {
        self.outcome
    }

    fn failed(&self) -> bool {
        self.outcome.is_some_and(|outcome| outcome != "put down")
    }
}
